#include "odpd/solvers/solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/core/timer.h"
#include "odpd/solvers/backends.h"
#include "odpd/solvers/preconditioner.h"

namespace odpd {

namespace {

constexpr int most_refinements = 5;
// What is left of a pure translation after the projection is rounding, not a load.
constexpr double projection_rounding = 1e-14;

const char* problem_text(const System& system) {
  if (system.holds_centre_of_mass()) return "centre of mass held still";
  return system.singular() ? "R v = f, null space removed" : "R v = f";
}

bool all_finite(std::span<const double> x) {
  return std::all_of(x.begin(), x.end(), [](double v) { return std::isfinite(v); });
}

}  // namespace

void Solver::bind(const System& system) {
  const Stopwatch watch;
  system_ = nullptr;  // stays so when the set-up throws
  assembly_seconds_ = 0.0;
  system_ = &system;
  generation_ = system.generation();
  try {
    set_up();
  } catch (...) {
    system_ = nullptr;
    throw;
  }
  setup_seconds_ = watch.seconds();
}

void Solver::require_bound(std::size_t b_size, std::size_t x_size) const {
  if (system_ == nullptr) throw SolverError(name() + ": solve was called before bind");
  if (system_->generation() != generation_)
    throw SolverError(name() + ": the system changed since bind: bind again before solve");
  const std::size_t size = index(system_->size());
  if (b_size != size || x_size != size) {
    throw SolverError(fmt::format("{}: b and x must have {} elements, not {} and {}", name(), size,
                                  b_size, x_size));
  }
}

SolveReport Solver::solve(std::span<const double> b, std::span<double> x, double tolerance) {
  tolerance_ = tolerance > 0.0 ? tolerance : options_.tolerance;
  require_bound(b.size(), x.size());
  const Stopwatch watch;
  SolveReport report;
  report.problem = problem_text(*system_);
  report.setup_seconds = setup_seconds_;
  report.assembly_seconds = assembly_seconds_;
  load_.assign(b.begin(), b.end());
  system_->project(load_);
  const double norm = system_->norm(load_);
  if (!std::isfinite(norm)) {
    report.failure = name() +
                     ": the right-hand side is not finite: look for overlapping particles, "
                     "extreme forces or a too large time step";
    report.residual = norm;
  } else if (norm == 0.0 ||
             (system_->projected() && norm <= projection_rounding * system_->norm(b))) {
    std::fill(x.begin(), x.end(), 0.0);
    report.converged = true;
  } else {
    iterate(norm, x, report);
  }
  report.note = note();
  report.memory_bytes =
      memory_bytes() + static_cast<std::int64_t>((load_.capacity() + residual_.capacity() +
                                                  correction_.capacity() + refined_.capacity()) *
                                                 sizeof(double));
  report.solve_seconds = watch.seconds();
  return report;
}

void Solver::iterate(double norm, std::span<double> x, SolveReport& report) {
  const Share share = system_->share();
  if (!share.ranks->all(all_finite(share.part(x, system_->block_size()))))
    std::fill(x.begin(), x.end(), 0.0);  // a guess need not be good
  system_->project(x);
  iterations_left_ = options_.max_iterations;
  Attempt last = attempt(load_, x, tolerance_);
  report.iterations = last.iterations;
  Measured measured = measure(x, norm);
  if (options_.stopping == Stopping::residual) {
    for (int k = 0; k < most_refinements && last.ok && measured.residual > tolerance_; ++k) {
      iterations_left_ = options_.max_iterations - report.iterations;
      const double before = measured.residual;
      last = refine(norm, x, measured);
      report.iterations += last.iterations;
      if (!(measured.residual < 0.5 * before)) break;
    }
  }
  report.residual = measured.residual;
  report.failure = verdict(last, measured, report.iterations);
  report.converged = report.failure.empty();
}

/// x += d with A d = residual, where that lowers the residual.
Solver::Attempt Solver::refine(double norm, std::span<double> x, Measured& measured) {
  const std::vector<double> load = residual_;
  correction_.assign(x.size(), 0.0);
  const double goal = std::clamp(0.5 * tolerance_ / measured.residual, 1e-15, 0.5);
  const Attempt result = attempt(load, correction_, goal);
  refined_.resize(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) refined_[i] = x[i] + correction_[i];
  const Measured after = measure(refined_, norm);
  if (after.residual < measured.residual) {
    std::copy(refined_.begin(), refined_.end(), x.begin());
    measured = after;
  } else {
    residual_ = load;
  }
  return result;
}

/// Fills residual_ = Pi (b - A x), x projected first where the problem is.
Solver::Measured Solver::measure(std::span<double> x, double norm) {
  system_->project(x);
  residual_.resize(x.size());
  system_->apply(x, residual_);
  Measured m;
  m.curvature = system_->inner_product(x, residual_);
  parallel_for(static_cast<std::int64_t>(x.size()), [&](std::int64_t k) {
    const std::size_t i = index(k);
    residual_[i] = load_[i] - residual_[i];
  });
  system_->project(residual_);
  m.residual = system_->norm(residual_) / norm;
  return m;
}

std::string Solver::verdict(const Attempt& last, const Measured& measured,
                            std::int64_t iterations) const {
  if (!last.ok && !last.failure.empty()) return name() + ": " + last.failure;
  if (!std::isfinite(measured.residual) || !std::isfinite(measured.curvature)) {
    return name() +
           ": the solution is not finite: the matrix is singular or far from positive "
           "definite; check that every particle is held by enough neighbours, or give them " +
           drag_cure + ", or mass (fluid.mass)";
  }
  const bool met =
      options_.stopping == Stopping::increment ? last.ok : measured.residual <= tolerance_;
  if (measured.curvature < 0.0 || (met && measured.curvature == 0.0))
    return name() + ": " + not_definite;
  if (met) return "";
  const std::string reached = fmt::format(
      "{}: after {} iterations the relative residual is {:.3g}, "
      "the tolerance {:.3g}",
      name(), iterations, measured.residual, tolerance_);
  if (!last.ok)
    return reached +
           ": raise solver.max_iterations, choose another solver.name, or a looser "
           "solver.tolerance";
  return reached +
         ", and refining gains no more: the matrix is singular or nearly so, or "
         "solver.tolerance is below what rounding allows";
}

}  // namespace odpd
