// Three sums along the path of a step (r, v1) -> (r*, v2) -> r' with noise, for phi_i a wave cos(k r_d) or sin(k r_d) across k:
//
//   G = dt [b phi(r).v1 + (1 - b) phi(r*).v2],   S = dt [phi(r) + phi(r')]/2 . v,   I = dt phi(r).v,   v = b v1 + (1 - b) v2
//
// In a step S - G is of order dt beside G, I - G of order dt^(1/2): both would do, were it not that what the latter leaves
// out has a mean. Over a time S and G, which are Stratonovich's sum as dt -> 0, grow alike; Ito's, I, does not: more where k is large, a little less where it is small.
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "odpd/analysis/block_average.h"
#include "odpd/analysis/waves.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/pairs/dpd.h"
#include "odpd/scene/scene.h"

// Of the waves `number` in an edge of 10, for a time: mean squares over windows of 0.3 of G, S, I; over steps of G, S - G, I - G.
odpd::BlockAverage squares(std::int64_t number, double dt, double time) {
  odpd::SceneSettings<2> settings;
  settings.box = {.size = {{10.0, 10.0}}, .periodic = {true, true}};
  settings.model = odpd::make_dpd<2>({.a = 18.5, .gamma = 4.5, .s = 0.5});
  odpd::Scene<2> scene(settings);
  odpd::Dynamics<2> dynamics(scene.box(), scene.particles(), scene.model(), scene,
                             odpd::make_solver({.name = "pcg", .tolerance = 1e-4}), {});
  const auto integrator = odpd::make_integrator<2>("trapezoidal");
  const odpd::Waves<2> waves({number}, {0, 1}, 10.0);
  odpd::BlockAverage average(6);
  std::vector<std::array<double, 3>> window(waves.modes().size());
  std::vector<double> sample(6, 0.0);
  const std::int64_t steps = std::llround(0.3 / dt);
  odpd::Clock clock{.dt = dt, .total_steps = std::llround((time + 3.0) / dt)};
  for (; !clock.finished(); clock.advance()) {
    const odpd::StepRecord<2>& step = integrator->step(dynamics, clock);
    if (clock.step < 10 * steps) continue;  // until the fluid has forgotten its lattice
    const auto sums = [&](const std::vector<odpd::Vec<2>>& r, const std::vector<odpd::Vec<2>>& v) {
      return waves.sums(scene.particles(), r, v);
    };
    const auto first = sums(step.start.position, step.start.velocity),
               second = sums(step.corrector.position, step.corrector.velocity),
               here = sums(step.start.position, step.v_mid),
               ahead = sums(scene.particles().position, step.v_mid);
    const double b = step.start_weight;
    for (std::size_t m = 0; m < window.size(); ++m) {
      const std::array<double, 3> now{dt * (b * first[m] + (1.0 - b) * second[m]),
                                      dt * 0.5 * (here[m] + ahead[m]), dt * here[m]};
      for (std::size_t c = 0; c < 3; ++c) {
        window[m][c] += now[c];
        sample[3 + c] += std::pow(now[c] - (c > 0 ? now[0] : 0.0), 2);
      }
    }
    if ((clock.step + 1) % steps != 0) continue;
    for (auto& mode : window)
      for (std::size_t c = 0; c < 3; ++c) sample[c] += std::pow(std::exchange(mode[c], 0.0), 2);
    average.add(std::exchange(sample, std::vector<double>(6, 0.0)));
  }
  return average;
}

int main(int words, char** word) {
  const double time = words > 1 ? std::atof(word[1]) : 2.0;
  std::array<std::array<double, 2>, 2>
      step{};  // of S and I, by dt: root mean square of what they differ from G
  for (const std::int64_t number : {1, 8})
    for (const double dt : {0.01, 0.005}) {
      const odpd::BlockAverage a = squares(number, dt, time);
      const auto more = [&](std::size_t c) { return 1e2 * (a.ratio(c, 0) - 1.0); };
      const auto error = [&](std::size_t c) {
        const odpd::BlockAverage::RatioTerm term{.numerator = c, .denominator = 0};
        return 1e2 * a.ratio_error({&term, 1});
      };
      for (std::size_t c = 0; c < 2; ++c) step[c][dt < 0.01] = std::sqrt(a.ratio(4 + c, 3));
      std::printf(
          "k = %.2f, dt = %.3f: more than G grow S by %5.2f +- %.2f %%, I by %5.2f +- %.2f %%\n",
          0.2 * std::acos(-1.0) * static_cast<double>(number), dt, more(1), error(1), more(2),
          error(2));
    }
  std::array<double, 2> order{};
  for (std::size_t c = 0; c < 2; ++c) order[c] = std::log2(step[c][0] / step[c][1]);
  std::printf(
      "in a step of 0.01 and 0.005: S - G %.4f, %.4f of G, order %.2f; I - G %.4f, %.4f, order "
      "%.2f\n",
      step[0][0], step[0][1], order[0], step[1][0], step[1][1], order[1]);
  return std::abs(order[0] - 1.0) < 0.2 && std::abs(order[1] - 0.5) < 0.2 ? 0 : 1;
}
