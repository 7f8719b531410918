// Rigid bodies among frozen friction-only particles must sample exp(-U/kT) whatever their resistance: a rotor in the plane
// and one in space, each in a trap, with the end of one arm drawn to one side, where a frozen particle is close.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "odpd/dynamics/integrator.h"
#include "odpd/pairs/dpd.h"

namespace odpd {
namespace {

constexpr double copy_spacing = 9.0;

template <int D>
Vec<D> copy_centre(const Vec<D>& r) {
  Vec<D> c;
  for (int k = 0; k < D; ++k) c[k] = (std::floor(r[k] / copy_spacing) + 0.5) * copy_spacing;
  return c;
}

constexpr double body_trap = 20.0;  // on every constituent: its sum knows the centre only
constexpr double pull = 1.0;        // along x on the first constituent of each body

// U = trap/2 sum |r_k - c|^2 - pull x_0, which is that of the centre plus -pull (Q b_0)_x.
template <int D>
class PulledTraps : public NoSurroundings<D> {
 public:
  explicit PulledTraps(std::int64_t size) : size_(size) {}
  void add_potential_forces(const Particles<D>& particles, std::span<const Vec<D>> positions,
                            std::vector<Vec<D>>& force) const override {
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (particles.is_known(i)) continue;
      force[i] -= body_trap * (positions[i] - copy_centre(positions[i]));
      if (particles.id[i] % size_ == 0) force[i][0] += pull;
    }
  }

 private:
  std::int64_t size_;
};

// Mean over copies and time of `value` of the body's direction Q b_0/|b_0|.
template <int D, class Value>
double mean_over_directions(const std::string& scheme, int copies, std::int64_t steps, double dt,
                            const Value& value) {
  Box<D> box;
  for (int c = 0; c < D; ++c) box.size[c] = copy_spacing * (c == 0 ? copies : 1);
  box.periodic.fill(true);
  RigidBody<D> body;
  for (const double x : {1.0, -1.0}) {
    Vec<D> b{};
    b[0] = x;
    body.frame.push_back(b);
  }
  if (D > 2)  // no body of constituents on a line
    for (const double y : {0.3, -0.3}) {
      Vec<D> b{};
      b[1] = y;
      b[D - 1] = y;
      body.frame.push_back(b);
    }
  Particles<D> particles;
  const auto centre = [&](int k) {
    Vec<D> c;
    for (int d = 0; d < D; ++d) c[d] = copy_spacing * (d == 0 ? k + 0.5 : 0.5);
    return c;
  };
  for (int k = 0; k < copies; ++k) {
    body.pose.centre = centre(k);
    particles.add_body(body, box, 0);
  }
  const auto size = static_cast<std::int64_t>(body.frame.size());
  for (int k = 0; k < copies; ++k) {
    const auto frozen = [&](std::initializer_list<double> at) {
      Vec<D> r = centre(k);
      int d = 0;
      for (const double x : at)
        if (d < D) r[d++] += x;
      particles.add(r, 0, 1);
    };
    frozen({1.15, 0.1, -0.1});  // strong friction where the pull leads
    for (int n = 0; n < 8; ++n) {
      const double angle = n * std::numbers::pi / 4.0;
      frozen({2.2 * std::cos(angle), 2.2 * std::sin(angle), 0.4 * (n % 2)});
    }
    if (D > 2)
      for (const double z : {-2.2, 2.2}) frozen({0.2, -0.3, z});
  }
  particles.walls = 1;
  const DpdModel<D> model(1, {DpdParameters{.a = 0.0, .gamma = 9.0, .s = 2.0, .cutoff = 2.0}});
  const PulledTraps<D> traps(size);
  DynamicsSettings settings;
  settings.reorder_every = 0;
  Dynamics<D> dynamics(box, particles, model, traps,
                       make_solver({.name = "pcg", .tolerance = 1e-8}), settings);
  const auto integrator = make_integrator<D>(scheme);
  double sum = 0.0, samples = 0.0;
  for (Clock clock{.dt = dt, .total_steps = steps}; !clock.finished(); clock.advance()) {
    integrator->step(dynamics, clock);
    if (clock.step < steps / 20) continue;
    for (const RigidBody<D>& b : particles.bodies) {
      if (b.known) continue;
      Vec<D> along = b.pose.orientation.turn(b.frame[0]);
      along *= 1.0 / norm(along);
      sum += value(along);
      samples += 1.0;
    }
  }
  return sum / samples;
}

double far_side(const Vec<2>& along) { return std::abs(std::atan2(along[1], along[0])) > 2.0; }

double exact_far_side() {
  double far = 0.0, all = 0.0;
  for (double a = -std::numbers::pi; a < std::numbers::pi; a += 1e-4) {
    all += std::exp(pull * std::cos(a));
    if (std::abs(a) > 2.0) far += std::exp(pull * std::cos(a));
  }
  return far / all;
}

// 200 rotors, relaxation time about 5: standard error about 1 % over t = 250.
TEST(BodyDrift, ARotorInThePlaneSamplesItsAngles) {
  EXPECT_NEAR(
      (mean_over_directions<2>("trapezoidal", 200, 25000, 0.01, far_side)) / exact_far_side(), 1.0,
      0.03);
}

TEST(BodyDrift, ARotorInThePlaneRejectsEuler) {
  EXPECT_LT((mean_over_directions<2>("euler", 200, 8000, 0.01, far_side)) / exact_far_side(), 0.9);
}

}  // namespace
}  // namespace odpd
