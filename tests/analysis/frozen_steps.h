#pragma once
// One step of a small scene with its dense friction matrix, for what frozen configurations answer to loads.
#include <cmath>
#include <memory>
#include <vector>

#include "odpd/dynamics/integrator.h"
#include "odpd/scene/scene.h"
#include "odpd/solvers/solver.h"
#include "support/points.h"

namespace frozen_steps {

using odpd::index;
using odpd::Vec;

/// x with (A + sum n n^T) x = b, by elimination.
std::vector<double> dense_solution(std::vector<std::vector<double>> A,
                                   const std::vector<std::vector<double>>& nulls,
                                   std::vector<double> b) {
  const std::size_t n = b.size();
  for (const auto& v : nulls)
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) A[i][j] += v[i] * v[j];
  for (std::size_t p = 0; p < n; ++p) {
    std::size_t best = p;
    for (std::size_t i = p; i < n; ++i)
      if (std::abs(A[i][p]) > std::abs(A[best][p])) best = i;
    std::swap(A[p], A[best]);
    std::swap(b[p], b[best]);
    for (std::size_t i = p + 1; i < n; ++i) {
      const double factor = A[i][p] / A[p][p];
      for (std::size_t j = p; j < n; ++j) A[i][j] -= factor * A[p][j];
      b[i] -= factor * b[p];
    }
  }
  for (std::size_t p = n; p-- > 0;) {
    for (std::size_t j = p + 1; j < n; ++j) b[p] -= A[p][j] * b[j];
    b[p] /= A[p][p];
  }
  return b;
}

template <int D>
odpd::SceneSettings<D> some_fluid() {
  odpd::SceneSettings<D> s;
  s.box.size = support::uniform_vec<D>(D == 2 ? 3.0 : 2.2);
  s.box.periodic.fill(true);
  s.count = D == 2 ? 30 : 34;
  s.model = odpd::make_dpd<D>({.a = 5.0, .gamma = 3.0, .gamma_perp = 1.0, .cutoff = 1.0});
  return s;
}

template <int D>
odpd::BodySettings<D> body_of(const std::vector<Vec<D>>& frame, std::int64_t count) {
  odpd::BodySettings<D> body;
  body.shape = frame;
  body.count = count;
  body.clearance = 0.05;
  return body;
}

/// A scene, one step of it, and its dense matrix.
template <int D>
struct OneStep {
  explicit OneStep(const odpd::SceneSettings<D>& settings)
      : scene(settings),
        dynamics(scene.box(), scene.particles(), scene.model(), scene,
                 odpd::make_solver({.name = "pcg", .tolerance = 1e-6}), {.seed = 3}),
        integrator(odpd::make_integrator<D>("trapezoidal")),
        record(integrator->step(dynamics, odpd::Clock{.dt = 0.005})) {
    const auto n = index(dynamics.dofs().unknowns());
    for (std::size_t k = 0; k < n; ++k) {
      std::vector<double> q(n, 0.0);
      q[k] = 1.0;
      matrix.push_back(dynamics.friction(record.start, q));
    }
    // Momentum of each unknown: with no net one the motion is relative to the mean of all particles.
    for (std::size_t c = 0; c < D; ++c)
      nulls.push_back(of_forces([&](std::size_t) {
        Vec<D> f{};
        f.x[c] = 1.0;
        return f;
      }));
    if (D == 2)  // the unused component of w
      for (std::size_t b = 0; b < index(dynamics.dofs().bodies()); ++b) {
        nulls.emplace_back(n, 0.0);
        nulls.back()[D * b + 1] = 1.0;
      }
  }

  /// P^T f of forces on particles.
  template <class Force>
  std::vector<double> of_forces(const Force& force) {
    std::vector<Vec<D>> f;
    for (std::size_t i = 0; i < record.start.position.size(); ++i) f.push_back(force(i));
    std::vector<double> q;
    dynamics.dofs().gather(record.start.arms, f, q);
    return q;
  }
  /// f . A^+ f of a load on unknowns, its net force spread over all particles.
  double answer(const std::vector<double>& f) {
    std::vector<double> load = f;
    const auto& translations = nulls;
    const std::size_t bodies = index(dynamics.dofs().bodies());
    const double n = static_cast<double>(record.start.position.size());
    for (std::size_t c = 0; c < D; ++c) {
      double net = 0.0;
      for (std::size_t k = D * bodies + c; k < load.size(); k += D) net += f[k];
      for (std::size_t k = 0; k < load.size(); ++k) load[k] -= net / n * translations[c][k];
    }
    const std::vector<double> v = dense_solution(matrix, nulls, load);
    double sum = 0.0;
    for (std::size_t k = 0; k < f.size(); ++k) sum += f[k] * v[k];
    return sum;
  }
  /// That of a unit force (torque) along direction c on some bodies.
  double of_bodies(const std::vector<std::size_t>& bodies, std::size_t c, bool turn) {
    std::vector<double> f(matrix.size(), 0.0);
    for (const std::size_t b : bodies) f[(turn ? b : dynamics.dofs().body_node(b)) * D + c] = 1.0;
    return answer(f);
  }
  odpd::Scene<D> scene;
  odpd::Dynamics<D> dynamics;
  std::unique_ptr<odpd::Integrator<D>> integrator;
  odpd::StepRecord<D> record;
  std::vector<std::vector<double>> matrix, nulls;
};

}  // namespace frozen_steps
