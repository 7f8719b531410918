// Preconditioned conjugate gradients on System::apply. On a projected system everything lives in
// the range of Pi: the operator is Pi A Pi, the preconditioner Pi M^-1 Pi.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "odpd/core/parallel.h"
#include "odpd/solvers/backends.h"
#include "odpd/solvers/preconditioner.h"

namespace odpd {

namespace {

// Residuals of conjugate gradients rise and fall, but never by this much on a regular system.
constexpr double divergence = 1e6;
constexpr const char* diverged =
    "the residual grows without bound: the matrix is singular and the forces are not balanced, as "
    "for a group of "
    "particles out of reach of all others; a weak pairwise friction of longer range "
    "(fluid.rattler_friction) joins them";

class ConjugateGradients : public Solver {
 public:
  ConjugateGradients(const SolverOptions& options, std::unique_ptr<Preconditioner> preconditioner)
      : Solver(options), preconditioner_(std::move(preconditioner)) {}

 private:
  void set_up() override {
    preconditioner_->set_up(*system_);
    for (auto* v : {&r_, &z_, &p_, &q_}) v->resize(index(system_->size()));
  }

  Attempt attempt(std::span<const double> b, std::span<double> x, double tolerance) override;
  void cycle(std::span<double> x, double goal, Attempt& result);
  double start(std::span<const double> b, std::span<const double> x);
  void project(std::span<double> v) const {
    if (system_->projected()) remove_mean(v, system_->block_size());
  }
  std::int64_t memory_bytes() const override {
    return preconditioner_->memory_bytes() +
           static_cast<std::int64_t>(4 * r_.size() * sizeof(double));
  }

  std::unique_ptr<Preconditioner> preconditioner_;
  std::vector<double> r_, z_, p_, q_;
};

/// r := Pi (b - A x), the true residual; returns its norm.
double ConjugateGradients::start(std::span<const double> b, std::span<const double> x) {
  system_->apply(x, r_);
  parallel_for(system_->size(), [&](std::int64_t i) { r_[index(i)] = b[index(i)] - r_[index(i)]; });
  project(r_);
  return fixed_norm(r_);
}

/// Iterates until the recursive residual is below `goal`; sets ok, or leaves it and says why.
void ConjugateGradients::cycle(std::span<double> x, double goal, Attempt& result) {
  const double first = fixed_norm(r_);
  double rho_before = 0.0;
  while (result.iterations < iterations_left_) {
    ++result.iterations;
    preconditioner_->apply(r_, z_);
    project(z_);
    const double rho = fixed_dot(r_, z_);
    const double beta = rho_before == 0.0 ? 0.0 : rho / rho_before;
    parallel_for(system_->size(),
                 [&](std::int64_t i) { p_[index(i)] = z_[index(i)] + beta * p_[index(i)]; });
    system_->apply(p_, q_);
    project(q_);
    const double curvature = fixed_dot(p_, q_);
    if (!(rho > 0.0) || !(curvature > 0.0)) {
      result.failure = std::isnan(rho) || std::isnan(curvature)
                           ? "numbers are no longer finite: the matrix has entries that are not"
                           : not_definite;
      return;
    }
    const double alpha = rho / curvature;
    parallel_for(system_->size(), [&](std::int64_t i) {
      x[index(i)] += alpha * p_[index(i)];
      r_[index(i)] -= alpha * q_[index(i)];
    });
    rho_before = rho;
    const double norm = fixed_norm(r_);
    if (norm <= goal) {
      result.ok = true;
      return;
    }
    if (norm > divergence * first) {
      result.failure = diverged;
      return;
    }
  }
}

Solver::Attempt ConjugateGradients::attempt(std::span<const double> b, std::span<double> x,
                                            double tolerance) {
  Attempt result;
  const double goal = tolerance * fixed_norm(b);
  double norm = start(b, x);
  // The recursive residual drifts from the true one: start over from the true one while that helps.
  while (norm > goal) {
    std::fill(p_.begin(), p_.end(), 0.0);
    result.ok = false;
    cycle(x, goal, result);
    if (!result.ok) return result;
    const double before = norm;
    norm = start(b, x);
    if (!(norm < 0.5 * before)) break;
  }
  if (std::isnan(norm)) result.failure = "numbers are no longer finite";
  result.ok = !std::isnan(norm);
  return result;
}

}  // namespace

std::unique_ptr<Solver> make_pcg(const SolverOptions& options) {
  return std::make_unique<ConjugateGradients>(options, std::make_unique<BlockJacobi>());
}

}  // namespace odpd
