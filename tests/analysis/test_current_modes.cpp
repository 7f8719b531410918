#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "odpd/analysis/current_decay.h"
#include "odpd/analysis/current_modes.h"
#include "odpd/analysis/registry.h"
#include "records.h"
#include "support/errors.h"

namespace {

using odpd::Config;
using odpd::CurrentModes;
using odpd::CurrentModeSettings;
using odpd::MaxwellFit;
using odpd::Scene;
using odpd::Vec;

std::vector<double> sampled(std::size_t count, double interval, const MaxwellFit& decay) {
  std::vector<double> c;
  for (std::size_t lag = 0; lag < count; ++lag)
    c.push_back(3.0 * decay(interval * static_cast<double>(lag)));
  return c;
}

// What solves dc/dt = -lam int exp(-(t - t')/tau)/tau c dt': as tau c'' + c' + lam c = 0, c(0) = 1, c'(0) = 0.
TEST(CurrentDecay, MaxwellsIsThatOfItsMemory) {
  for (const double tau : {0.02, 0.3, 0.5, 4.0}) {  // W real, imaginary, and zero at 0.5
    const MaxwellFit decay{0.5, tau};
    EXPECT_DOUBLE_EQ(decay(0.0), 1.0);
    const double h = 1e-3 * tau, t = 0.7;
    const double low = decay(t - h), at = decay(t), high = decay(t + h);
    EXPECT_NEAR(tau * (high - 2.0 * at + low) / (h * h) + 0.5 * (high - low) / h + 0.5 * at, 0.0,
                1e-6);
    EXPECT_NEAR((1.0 - decay(h)) / h, 0.25 * h / tau, 1e-3);
    EXPECT_NEAR(decay.area_beyond(0.0, 1e-3), 2.0, 1e-4);
  }
}

TEST(CurrentDecay, FitsGiveWhatDecaysWereMadeOf) {
  for (const double tau : {-0.04, 0.0, 0.05, 0.2, 1.0}) {
    SCOPED_TRACE(tau);
    const auto c = sampled(80, 0.05, {1.5, tau});
    const MaxwellFit fit = odpd::fit_maxwell(c, 0.05);
    EXPECT_NEAR(fit.rate, 1.5, 1e-5);
    EXPECT_NEAR(fit.tau, tau, 1e-5);
    if (tau == 0.0) {
      EXPECT_NEAR(odpd::fit_exponential(c, 0.05), 1.5, 1e-8);
    }
    // Of the trapezoidal rule, whose error is interval^2/12 of the slopes' difference.
    if (tau < 0.0) continue;
    for (const std::size_t join : {10u, 60u})
      EXPECT_NEAR(odpd::decay_area(c, 0.05, join, fit), 1.0 / 1.5, 4e-4);
  }
  EXPECT_TRUE(std::isnan(odpd::fit_exponential(std::vector<double>{1.0, 1.1, 1.2}, 0.05)));
}

/// q^l as half-way velocities have it, and the mean of two of them as full-step ones do.
std::vector<double> chain(double q, bool half_way) {
  std::vector<double> c;
  for (int lag = 0; lag < 200; ++lag)
    c.push_back(half_way   ? std::pow(q, lag)
                : lag == 0 ? 0.5 * (1.0 + q)
                           : std::pow(q, lag) * (2.0 + q + 1.0 / q) / 4.0);
  return c;
}

// docs/generalised-hydrodynamics.md: the mean of two half-way velocities looks like a memory of half a step.
TEST(CurrentDecay, FullStepsOfHalfWayVelocitiesShowATimeOfHalfAStep) {
  for (const double rate : {0.01, 0.03}) {  // times dt = 1
    EXPECT_NEAR(odpd::fit_maxwell(chain(1.0 - rate, true), 1.0).tau, 0.0, 1e-4);
    EXPECT_NEAR(odpd::fit_maxwell(chain(1.0 - rate, false), 1.0).tau, 0.5, 2.0 * rate);
  }
}

/// Six particles along x, on whose places waves are orthogonal, with currents of unit rate put on them.
struct OrnsteinUhlenbeck {
  static constexpr std::size_t n = 6;
  static constexpr double edge = 6.0, kT = 1.7, mass = 0.6, dt = 0.1;
  OrnsteinUhlenbeck()
      : scene([] {
          std::vector<Vec<2>> r;
          for (std::size_t i = 0; i < n; ++i) r.push_back({{static_cast<double>(i), 3.0}});
          auto s = records::periodic<2>(edge, r);
          s.model = odpd::make_dpd<2>({.a = 0.0, .gamma = 2.0, .s = 0.0, .cutoff = 1.5, .kT = kT});
          s.mass = mass;
          return s;
        }()) {}
  /// A part of a current that falls by q in a step, of this mean square over N kT/(2 m).
  struct Part {
    double q, square;
  };
  /// eta.1 and so on of one part whose rate times dt is x.
  odpd::Results run(double x, bool half_way_chain, bool half_way, std::int64_t every = 1) {
    // Of half-way velocities such that full-step ones have kT/m.
    const Part part =
        half_way_chain ? Part{1.0 - x, 1.0 / (1.0 - 0.5 * x)} : Part{(2.0 - x) / (2.0 + x), 1.0};
    return run({part}, 6.0 / x, half_way_chain, half_way, every);
  }
  odpd::Results run(const std::vector<Part>& parts, double window, bool half_way_chain,
                    bool half_way, std::int64_t every = 1) {
    CurrentModes<2> modes(
        {.kind = "modes", .name = "modes", .every = every},
        {.numbers = {1}, .axes = {0}, .window = window * dt, .half_way = half_way}, scene, dt);
    odpd::StepRecord<2> record = records::record(scene);
    const double k = 2.0 * std::numbers::pi / edge;
    const auto set = [&](const std::array<double, 2>& current) {
      std::vector<Vec<2>> v(n);
      for (std::size_t i = 0; i < n; ++i) {
        const double angle = k * record.start.position[i][0];
        v[i][1] = 2.0 / n * (current[0] * std::cos(angle) + current[1] * std::sin(angle));
      }
      return v;
    };
    const auto w = support::random_numbers(2 * parts.size() * steps, 5);
    std::vector<double> part(2 * parts.size(), 0.0);
    std::array<double, 2> j{};
    for (std::size_t step = 0; step < steps; ++step) {
      const std::array<double, 2> before = j;
      j = {};
      for (std::size_t p = 0; p < part.size(); ++p) {
        const auto [q, square] = parts[p / 2];
        const double spread = std::sqrt(0.5 * n * kT / mass * square * (1.0 - q * q));
        part[p] = q * part[p] + spread * w[part.size() * step + p];
        j[p % 2] += part[p];
      }
      record.v_mid = set(j);
      record.v_start =
          half_way_chain ? set({0.5 * (j[0] + before[0]), 0.5 * (j[1] + before[1])}) : record.v_mid;
      if (step > 50 && step % static_cast<std::size_t>(every) == 0)
        modes.measure(odpd::Clock{.dt = dt}, scene.particles(), record);
    }
    return records::results(modes);
  }
  double exact(double x) const {
    const double k = 2.0 * std::numbers::pi / edge;
    return n * mass / (edge * edge) * x / dt / (k * k);
  }
  static constexpr std::size_t steps = 20000;
  Scene<2> scene;
};

// Modes of a known rate, through all of it.
TEST(CurrentModes, ModesWithoutMemoryHaveTheirRate) {
  OrnsteinUhlenbeck modes;
  for (const double x : {0.1, 0.3}) {
    const double exact = modes.exact(x);
    for (const std::int64_t every : {1, 2})
      for (const bool half_way : {true, false}) {
        SCOPED_TRACE(testing::Message() << x << " " << every << " " << half_way);
        const auto results = modes.run(x, half_way, half_way, every);
        for (const char* what : {"modes.eta.1", "modes.exp.1", "modes.maxwell.1"}) {
          const double error = records::error(results, what);
          EXPECT_NEAR(records::mean(results, what), exact, 3.0 * error) << what;
          EXPECT_LT(error, 0.06 * exact) << what;
          EXPECT_GT(error, 0.005 * exact) << what;
        }
        EXPECT_NEAR(records::mean(results, "modes.tau.1"), 0.0,
                    3.0 * records::error(results, "modes.tau.1"));
        EXPECT_LT(records::error(results, "modes.tau.1"), 0.06 * 0.1 / x);
        const double start = half_way && every > 1 ? 1.0 / (1.0 - 0.5 * x) : 1.0;
        EXPECT_NEAR(records::mean(results, "modes.equipartition.1"), start,
                    3.0 * records::error(results, "modes.equipartition.1"));
        EXPECT_LT(records::error(results, "modes.equipartition.1"), 0.06);
      }
  }
}

// Currents of two rates: an area of sum V (1 + q)/(1 - q) dt/2, where full steps have a mean square of sum V (1 + q)/2 = 1.
// That of an exponential of the same area is a seventh more.
TEST(CurrentModes, FullStepsSetTheNormOfHalfWayVelocities) {
  OrnsteinUhlenbeck modes;
  const auto results = modes.run({{0.8, 1.0 / 1.45}, {0.1, 1.0 / 1.45}}, 30.0, true, true);
  const double area = (0.9 / 0.2 + 0.55 / 0.9) / 1.45;
  const double error = records::error(results, "modes.eta.1");
  EXPECT_NEAR(records::mean(results, "modes.eta.1"), modes.exact(1.0 / area), 3.0 * error);
  EXPECT_LT(error, 0.035 * modes.exact(1.0 / area));
  EXPECT_NEAR(records::mean(results, "modes.equipartition.1"), 1.0,
              3.0 * records::error(results, "modes.equipartition.1"));
}

// The full-step velocities of the chain of half-way ones: the same area, but a time of half a step.
TEST(CurrentModes, FullStepsShowATimeThatIsNone) {
  OrnsteinUhlenbeck modes;
  constexpr double x = 0.3, half_step = 0.05;
  const auto results = modes.run(x, true, false);
  const double tau = records::mean(results, "modes.tau.1");
  const double error = records::error(results, "modes.tau.1");
  EXPECT_NEAR(tau, half_step, 3.0 * error);
  EXPECT_GT(tau, 4.0 * error);
  EXPECT_NEAR(records::mean(results, "modes.eta.1"), modes.exact(x),
              3.0 * records::error(results, "modes.eta.1"));
  EXPECT_NEAR(records::mean(results, "modes.equipartition.1"), 1.0,
              3.0 * records::error(results, "modes.equipartition.1"));
  ASSERT_FALSE(results.notes.empty());
  EXPECT_NE(results.notes.front().find("modes.tau.1"), std::string::npos);
}

// C(k, 0) = k^2 kT/m of all currents in a run, and eta(k) little below eta_inf(k).
TEST(CurrentModes, FluidWithMassHasEquipartitionAndViscosity) {
  const Config config = Config::from_text(R"(
    [box]
    size = [6.0, 6.0]
    periodic = [true, true]
    [fluid]
    density = 4.0
    mass = 1.0
    a = 5.0
    gamma = 4.5
    kT = 1.0
  )",
                                          "case.toml");
  Scene<2> scene(odpd::read_scene_settings<2>(config));
  odpd::Dynamics<2> dynamics(scene.box(), scene.particles(), scene.model(), scene,
                             odpd::make_solver({.name = "pcg"}), {.seed = 5});
  const auto integrator = odpd::make_integrator<2>("velocity-verlet");
  odpd::Clock clock{.dt = 0.02, .equilibration_steps = 100, .total_steps = 2600};
  CurrentModes<2> modes({.kind = "modes", .name = "modes"},
                        {.numbers = {3, 6}, .axes = {0, 1}, .half_way = true}, scene, clock.dt);
  while (!clock.finished()) {
    const auto& record = integrator->step(dynamics, clock);
    clock.advance();
    if (modes.is_due(clock)) modes.measure(clock, scene.particles(), record);
  }
  const auto results = records::results(modes);
  for (const std::size_t wave : {0u, 1u}) {
    SCOPED_TRACE(wave);
    const auto of = [&](const char* what) {
      const std::string name = std::string("modes.") + what + "." + std::to_string(wave + 1);
      return std::pair(records::mean(results, name), records::error(results, name));
    };
    const auto [eta, eta_error] = of("eta");
    const auto [start, start_error] = of("equipartition");
    EXPECT_NEAR(start, 1.0, 4.0 * start_error);
    EXPECT_LT(start_error, 0.08);
    EXPECT_NEAR(eta, 0.95 * of("eta_inf").first, 4.0 * eta_error);
    EXPECT_LT(eta_error, 0.12 * eta);
  }
  // Longitudinal waves rub three times as much (e_x^4 against e_x^2 e_y^2 in the mean over directions).
  const auto& first = results.tables.at(1).second.rows.front();
  const double k = std::numbers::pi;
  const double x = 3.0 * records::mean(results, "modes.eta_inf.1") * k * k / 4.0 * clock.dt;
  EXPECT_NEAR(first.at(4), 1.0 / (1.0 - 0.5 * x), 4.0 * first.at(5));
  EXPECT_LT(first.at(5), 0.05);
}

TEST(CurrentModes, RefuseWhatIsNoFluidAtRest) {
  const auto refused = [](const odpd::SceneSettings<2>& s, const std::string& keys,
                          std::initializer_list<const char*> parts) {
    const Scene<2> scene(s);
    const Config config = Config::from_text("[[observe]]\nkind = \"modes\"\n" + keys, "case.toml");
    support::expect_error<odpd::ConfigError>(
        [&] {
          odpd::make_observers<2>(config, scene, odpd::Clock{.dt = 0.02},
                                  odpd::integrator_traits("shardlow"));
          config.reject_unread();
        },
        parts);
  };
  auto s = records::periodic<2>(5.0, {{{1.0, 1.0}}, {{3.0, 3.0}}});
  s.mass = 1.0;
  auto cold = s, dragged = s, pushed = s, walled = s;
  cold.model = odpd::make_dpd<2>({.kT = 0.0});
  dragged.zeta_0 = 0.1;
  pushed.body_force[0] = 1.0;
  records::add_walls(walled, 0.0);
  refused(cold, "", {"case.toml:2", "kind", "kT"});
  refused(dragged, "", {"kind", "zeta_0"});
  refused(pushed, "", {"kind", "no force or torque"});
  refused(walled, "", {"kind", "walls"});
  refused(s, "control = true\n", {"control", "without mass"});
  refused(s, "control_every = 2\n", {"control_every", "without mass"});
  refused(s, "fit_from = 0.2\n", {"fit_from", "without mass"});
  refused(s, "window = 0.1\n", {"window", "8 samples"});
  refused(s, "window = 50.0\n", {"window", "2500", "every"});
}

}  // namespace
