#pragma once
// Real DPD configurations for the contract tests: three models, three geometries, two dimensions.
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "odpd/core/error.h"
#include "odpd/core/parallel.h"
#include "odpd/dynamics/dynamics.h"
#include "odpd/scene/scene.h"
#include "support/network.h"

namespace contract {

enum class Model { central, transverse, far_friction };
enum class Geometry { walls, periodic, open };

inline std::string name(Model model) {
  return model == Model::central ? "central" : model == Model::transverse ? "transverse" : "far";
}
inline std::string name(Geometry geometry) {
  return geometry == Geometry::walls      ? "walls"
         : geometry == Geometry::periodic ? "periodic"
                                          : "open";
}

/// Fluid of density 4 in a cube of edge `length`; walls, one of them moving, lie outside it. An
/// open box ends in the void: nothing but the operator can be asked there.
template <int D>
odpd::SceneSettings<D> settings(Model model, Geometry geometry, double length) {
  odpd::SceneSettings<D> s;
  s.seed = 5;
  s.box.size = support::uniform_vec<D>(length);
  s.box.periodic.fill(geometry != Geometry::open);
  odpd::DpdParameters& p = s.pairs[0];
  p.kT = 0.7;
  if (model == Model::transverse) p.gamma_perp = 1.5;
  if (model == Model::far_friction) {
    p.gamma_far = 0.1;
    p.cutoff_far = 1.5;
  }
  if (geometry != Geometry::walls) return s;
  s.box.size[D - 1] += 2.0;
  s.box.periodic[D - 1] = false;
  s.body_force[0] = 0.2;
  for (const bool high : {false, true}) {
    odpd::WallSettings<D> wall;
    wall.axis = D - 1;
    wall.high = high;
    wall.velocity[0] = high ? 1.0 : 0.0;
    for (const double depth : {0.0, 0.5}) {
      wall.layers.push_back({.depth = depth, .count = 0, .spacing = D == 2 ? 0.25 : 0.5});
    }
    s.walls.push_back(wall);
  }
  return s;
}

/// One instant of a run: edges, R and the right-hand side with noise, wall motion and body force.
template <int D>
class Instant {
 public:
  Instant(Model model, Geometry geometry, double length, bool hold = false)
      : scene(settings<D>(model, geometry, length)),
        dynamics(scene.box(), scene.particles(), scene.model(), scene, odpd::make_solver({}),
                 {.hold_centre_of_mass = hold}) {
    // One thread, or the threads of several test programs at once wait for each other.
    odpd::set_threads(1, 0);
    dynamics.evaluate(scene.particles().position, 0.0, stage);
    std::vector<odpd::Vec<D>> edge_noise;
    const auto xi = dynamics.draw_noise(stage, 3, 0.01, edge_noise);
    dynamics.assemble(stage, {});
    load = dynamics.force(stage);
    for (std::size_t k = 0; k < load.size(); ++k) load[k] += xi[k];
  }

  odpd::Scene<D> scene;
  odpd::Dynamics<D> dynamics;
  odpd::Stage<D> stage;
  std::vector<double> load;

  const odpd::Resistance<D>& resistance() const { return dynamics.resistance(); }
};

/// The instant of these arguments, made once in a program: filling and relaxing a box takes longer
/// than the checks of it.
template <int D>
const Instant<D>& instant_of(Model model, Geometry geometry, double length, bool hold = false) {
  static std::map<std::tuple<Model, Geometry, double, bool>, Instant<D>> made;
  return made.try_emplace({model, geometry, length, hold}, model, geometry, length, hold)
      .first->second;
}

inline std::vector<double> product(const odpd::System& system, const std::vector<double>& x) {
  std::vector<double> y(x.size());
  system.apply(x, y);
  return y;
}

/// |Pi (b - A x)| / |Pi b|, worked out here, not by the solver.
inline double true_residual(const odpd::System& system, std::vector<double> b,
                            const std::vector<double>& x) {
  std::vector<double> r = product(system, x);
  for (std::size_t k = 0; k < r.size(); ++k) r[k] = b[k] - r[k];
  if (system.projected()) {
    for (auto* vector : {&r, &b}) odpd::remove_mean(*vector, system.block_size());
  }
  return support::norm(r) / support::norm(b);
}

}  // namespace contract
