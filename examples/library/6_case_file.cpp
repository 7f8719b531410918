// A case file, read and changed: cases/03_poiseuille with twice the force, for a shorter time. Flow and walls balance,
//
//   F_wall = N f/(2 L),   N: particles, f: force on each, L: length of a wall
//
// so twice the force f is twice the force on each wall; the viscosity is a property of the fluid and stays as it was.
//
// Usage: example_case_file cases/03_poiseuille
#include <cmath>
#include <cstdio>

#include "odpd/app/simulation.h"

int main(int count, char** words) try {
  if (count != 2) return std::printf("usage: example_case_file CASE\n"), 1;
  // As `odpd run CASE --set body_force.force="[1.0, 0.0]" --set run.duration=5.0` would.
  const odpd::Config config =
      odpd::open_case(words[1], {"body_force.force=[1.0, 0.0]", "run.duration=5.0"});
  odpd::Simulation<2> simulation(config, odpd::read_case(config, odpd::case_name(words[1])));
  while (!simulation.clock().finished()) simulation.step();
  const odpd::Results results = simulation.results();
  for (const char* name : {"wall.y-.x", "wall.y+.x", "profile.maximum", "profile.viscosity"}) {
    const odpd::Scalar s = *results.find(name);
    std::printf("%-18s %.3f +- %.3f\n", name, s.mean, s.standard_error);
  }

  const odpd::Scene<2>& scene = simulation.scene();
  const double force =
      static_cast<double>(scene.particles().free_count()) * 1.0 / (2.0 * scene.box().size[0]);
  const auto near = [&](const char* name, double expected, double relative) {
    return std::abs(results.find(name)->mean - expected) < relative * expected;
  };
  return near("wall.y-.x", force, 0.03) && near("profile.viscosity", 3.2, 0.1) ? 0 : 1;
} catch (const odpd::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return error.exit_code();
}
