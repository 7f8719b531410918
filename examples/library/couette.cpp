// odpd as a library: a small Couette cell, built from a case in a string, stepped by hand.
#include <cstdio>

#include "odpd/core/config.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/scene/scene.h"

int main() {
  const odpd::Config config = odpd::Config::from_text(R"(
    [box]
    size = [6.0, 8.0]
    periodic = [true, false]
    [fluid]
    density = 4.0
    kT = 1.0
    a = 18.5
    gamma = 4.5
    [[wall]]
    side = "y-"
    velocity = [-2.0, 0.0]
    layers = [{ depth = 0.0, count = 30 }, { depth = 0.5, count = 12 }]
    [[wall]]
    side = "y+"
    velocity = [2.0, 0.0]
    layers = [{ depth = 0.0, count = 30 }, { depth = 0.5, count = 12 }]
  )",
                                                      "couette");

  odpd::Scene<2> scene(odpd::read_scene_settings<2>(config));
  odpd::Dynamics<2> dynamics(scene.box(), scene.particles(), scene.model(), scene,
                             odpd::make_solver({.name = "pcg", .tolerance = 1e-5}), {});
  const auto integrator = odpd::make_integrator<2>("trapezoidal");

  odpd::Clock clock{.dt = 0.005, .total_steps = 400};
  double upper = 0.0, lower = 0.0;
  while (!clock.finished()) {
    const odpd::StepRecord<2>& record = integrator->step(dynamics, clock);
    clock.advance();
    for (std::size_t i = 0; i < record.v_mid.size(); ++i)
      if (scene.particles().is_free(i))
        (record.start.position[i][1] > 4.0 ? upper : lower) += record.v_mid[i][0];
  }
  const double half = 0.5 * static_cast<double>(scene.particles().free_count() * clock.total_steps);
  std::printf("mean v_x below the middle %.3f, above it %.3f\n", lower / half, upper / half);
  return upper > lower ? 0 : 1;
}
