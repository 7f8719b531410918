#pragma once
// Scenes with given positions, and step records as an integrator would leave them.
#include <cmath>
#include <memory>
#include <vector>

#include "odpd/analysis/results.h"
#include "odpd/dynamics/clock.h"
#include "odpd/dynamics/step_record.h"
#include "odpd/operator/edge_sums.h"
#include "odpd/pairs/dpd.h"
#include "odpd/scene/scene.h"
#include "support/points.h"

namespace records {

template <int D>
odpd::SceneSettings<D> periodic(double length, const std::vector<odpd::Vec<D>>& positions) {
  odpd::SceneSettings<D> s;
  s.box.size = support::uniform_vec<D>(length);
  s.box.periodic.fill(true);
  s.start = odpd::StartKind::file;
  s.start_positions = positions;
  s.relax_sweeps = 0;
  return s;
}

/// Adds walls of one layer at depth 0 at both ends of y, moving with -u and +u along x.
template <int D>
void add_walls(odpd::SceneSettings<D>& s, double u) {
  s.box.periodic[1] = false;
  for (const bool high : {false, true}) {
    odpd::WallSettings<D> wall;
    wall.axis = 1;
    wall.high = high;
    wall.velocity[0] = high ? u : -u;
    wall.layers = {{.depth = 0.0, .count = 0, .spacing = 0.5}};
    s.walls.push_back(wall);
  }
}

/// Positions, edges and potential forces of the scene's particles as they are now.
template <int D>
odpd::StepRecord<D> record(const odpd::Scene<D>& scene) {
  odpd::StepRecord<D> record;
  record.dt = 0.01;
  odpd::Stage<D>& stage = record.start;
  stage.box = scene.box();
  stage.position = scene.particles().position;
  odpd::PairList<D> list(scene.box(), scene.model().cutoff(), 0.0);
  list.update(stage.position);
  scene.model().write_edges(list, scene.box(), stage.position, scene.particles(), stage.network);
  stage.potential_force.resize(stage.position.size());
  odpd::add_conservative_forces(stage.network, stage.potential_force);
  scene.add_potential_forces(scene.particles(), stage.position, stage.potential_force);
  stage.velocity.resize(stage.position.size());
  record.v_mid = stage.velocity;
  return record;
}

template <class Observer>
odpd::Results results(const Observer& observer) {
  odpd::Results r;
  observer.add_results(r);
  return r;
}

inline double mean(const odpd::Results& results, const std::string& name) {
  const odpd::Scalar* scalar = results.find(name);
  return scalar == nullptr ? std::nan("") : scalar->mean;
}

inline double error(const odpd::Results& results, const std::string& name) {
  const odpd::Scalar* scalar = results.find(name);
  return scalar == nullptr ? std::nan("") : scalar->standard_error;
}

}  // namespace records
