#pragma once
// The whole trapezoidal step by phase.
#include <array>
#include <memory>

#include "configuration.h"
#include "odpd/core/timer.h"
#include "odpd/dynamics/integrator.h"

namespace bench {

/// ns per mobile particle and step, and iterations per solve.
struct StepTimes {
  double iterations = 0.0;
  std::array<double, 5> phases{};  ///< neighbours, edges, noise, assembly, solve
  double rest = 0.0, all = 0.0;

  /// In the order of steps.csv.
  std::array<double, 8> columns() const {
    return {iterations, phases[0], phases[1], phases[2], phases[3], phases[4], rest, all};
  }
};

/// A scene that steps with `pcg`, warmed up by two steps.
template <int D>
class Stepped {
 public:
  Stepped(odpd::Scene<D>& scene, double tolerance)
      : dynamics_(scene.box(), scene.particles(), scene.model(), scene,
                  odpd::make_solver({.name = "pcg", .tolerance = tolerance}), {.seed = seed}),
        integrator_(odpd::make_integrator<D>("trapezoidal")) {
    for (; clock_.step < 2; clock_.advance()) integrator_->step(dynamics_, clock_);
  }

  StepTimes advance(std::int64_t steps) {
    dynamics_.phases() = {};
    const odpd::SolverStatistics before = dynamics_.statistics();
    const odpd::Stopwatch watch;
    const std::int64_t last = clock_.step + steps;
    for (; clock_.step < last; clock_.advance()) integrator_->step(dynamics_, clock_);
    const double all = watch.seconds();
    const double per = 1e9 / static_cast<double>(steps * dynamics_.dofs().mobile());
    StepTimes times;
    times.iterations = static_cast<double>(dynamics_.statistics().iterations - before.iterations) /
                       static_cast<double>(dynamics_.statistics().solves - before.solves);
    times.all = times.rest = per * all;
    using odpd::Phase;
    const std::array phases{Phase::neighbours, Phase::edges, Phase::noise, Phase::assembly,
                            Phase::solve};
    for (std::size_t k = 0; k < phases.size(); ++k) {
      times.phases[k] = per * dynamics_.phases()[phases[k]];
      times.rest -= times.phases[k];
    }
    return times;
  }

 private:
  odpd::Dynamics<D> dynamics_;
  std::unique_ptr<odpd::Integrator<D>> integrator_;
  odpd::Clock clock_{.dt = time_step};
};

}  // namespace bench
