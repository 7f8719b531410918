#pragma once
// Rotors as rigid bodies of two constituents: the hub is in a trap, a couple turns the tip towards angle 0, where a cluster of
// frozen friction-only particles is close. Many copies share a box, out of each other's reach.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "odpd/dynamics/integrator.h"
#include "odpd/pairs/dpd.h"

namespace support {

using namespace odpd;  // of the library under test

constexpr double rotor_spacing = 8.0;
constexpr int rotors_per_side = 20;
constexpr double couple = 0.5;     // U = -couple cos(angle), kT = 1
constexpr double hub_trap = 24.0;  // spring constant

inline Vec<2> rotor_centre(const Vec<2>& r) {
  Vec<2> c;
  for (int k = 0; k < 2; ++k) c[k] = (std::floor(r[k] / rotor_spacing) + 0.5) * rotor_spacing;
  return c;
}

class Rotors : public NoSurroundings<2> {
 public:
  void add_potential_forces(const Particles<2>& particles, std::span<const Vec<2>> positions,
                            std::vector<Vec<2>>& force) const override {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (particles.is_known(i)) continue;
      const bool hub = particles.id[i] % 2 == 0;
      force[i] += Vec<2>{{hub ? -couple : couple, 0.0}};
      if (hub) force[i] -= hub_trap * (positions[i] - rotor_centre(positions[i]));
    }
  }
};

struct Fraction {
  double value, standard_error;
};

// Fraction of the time that tips spend more than a quarter turn from angle 0, where a frozen particle is close, relative to the
// exact one; started from the exact distribution. Standard error from ten blocks of copies.
inline Fraction rotors_turned_away(const std::string& scheme, std::int64_t steps,
                                   double dt = 0.01) {
  const double edge = rotors_per_side * rotor_spacing;
  const Box<2> box{{{edge, edge}}, {true, true}};
  constexpr int points = 10000;
  std::vector<double> cumulative{0.0};
  double away = 0.0;
  for (int k = 0; k < points; ++k) {
    const double angle = 2.0 * std::numbers::pi * ((k + 0.5) / points - 0.5);
    const double weight = std::exp(couple * std::cos(angle));
    cumulative.push_back(cumulative.back() + weight);
    if (std::cos(angle) < 0.0) away += weight;
  }
  away /= cumulative.back();
  Particles<2> particles;
  RigidBody<2> rotor;
  rotor.frame = {{{-0.5, 0.0}}, {{0.5, 0.0}}};
  std::vector<Vec<2>> centres;
  for (int x = 0; x < rotors_per_side; ++x)
    for (int y = 0; y < rotors_per_side; ++y)
      centres.push_back({{(x + 0.5) * rotor_spacing, (y + 0.5) * rotor_spacing}});
  for (std::size_t k = 0; k < centres.size(); ++k) {
    // The golden ratio spreads the starts evenly over the distribution, without order among neighbours.
    const double u = std::fmod(0.5 + 0.6180339887498949 * static_cast<double>(k), 1.0);
    const auto at = std::lower_bound(cumulative.begin(), cumulative.end(), u * cumulative.back());
    const double angle =
        2.0 * std::numbers::pi * (static_cast<double>(at - cumulative.begin()) / points - 0.5);
    rotor.pose.orientation = {};
    rotor.pose.orientation.advance({{angle, 0.0}});
    rotor.pose.centre = centres[k] + 0.5 * Vec<2>{{std::cos(angle), std::sin(angle)}};
    particles.add_body(rotor, box, 0);
  }
  for (const Vec<2>& c : centres) {
    for (int k = 0; k < 8; ++k)
      particles.add(c + Vec<2>{{1.1 + 0.01 * k, 0.05}}, 0, odpd::Group::wall(0));
    for (int k = 0; k < 6; ++k) {  // some friction all the way round
      const double angle = (k + 0.5) * std::numbers::pi / 3.0;
      particles.add(c + 1.7 * Vec<2>{{std::cos(angle), std::sin(angle)}}, 0, odpd::Group::wall(0));
    }
  }
  particles.walls = 1;
  const DpdModel<2> model(1, {DpdParameters{.a = 0.0, .gamma = 1.5, .s = 0.5, .cutoff = 2.0}});
  const Rotors torques;
  Dynamics<2> dynamics(box, particles, model, torques,
                       make_solver({.name = "pcg", .tolerance = 1e-5}), DynamicsSettings{});
  const auto integrator = make_integrator<2>(scheme);
  std::vector<double> turned(10, 0.0);
  for (Clock clock{.dt = dt, .total_steps = steps}; !clock.finished(); clock.advance()) {
    integrator->step(dynamics, clock);
    for (std::size_t b = 0; b < particles.bodies.size(); ++b) {
      const auto index = dynamics.dofs().constituents(b);
      const Vec<2> along = box.separation(particles.position[static_cast<std::size_t>(index[1])],
                                          particles.position[static_cast<std::size_t>(index[0])]);
      turned[b * 10 / particles.bodies.size()] += along[0] < 0.0 ? 1.0 : 0.0;
    }
  }
  double mean = 0.0, square = 0.0;
  for (double& t : turned) {
    t /= away * static_cast<double>(steps) * static_cast<double>(centres.size()) / 10.0;
    mean += t / 10.0;
  }
  for (const double t : turned) square += (t - mean) * (t - mean);
  return {mean, std::sqrt(square / 90.0)};
}

}  // namespace support
