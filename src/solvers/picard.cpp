// Block-Jacobi iteration, plain and deflated (Phan-Thien et al. 2016, sec. 3).
//
//   Scheme 1   x_l = x + D^-1 (b - A x)                    eq. 24
//   Scheme 2   x_l = x + D^-1 Pi (b - A x) - E E^T x       eq. 41-46, E the normalised translations
#include <algorithm>
#include <cmath>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/solvers/backends.h"
#include "odpd/solvers/preconditioner.h"

namespace odpd {

namespace {

constexpr double growth_limit = 1e6;  // growth of the residual that ends the iteration

class Picard : public Solver {
 public:
  Picard(const SolverOptions& options, bool deflated) : Solver(options), deflated_(deflated) {}

 private:
  void set_up() override {
    if (deflated_ && !system_->projected())
      throw SolverError(
          "picard-deflated holds the centre of mass still: set solver.hold_centre_of_mass = true");
    inverse_diagonal_.set_up(*system_);
    residual_.resize(index(system_->size()));
    step_.resize(residual_.size());
  }

  Attempt attempt(std::span<const double> b, std::span<double> x, double tolerance) override;
  double update(std::span<double> x);
  std::int64_t memory_bytes() const override {
    return inverse_diagonal_.memory_bytes() +
           static_cast<std::int64_t>((residual_.size() + step_.size()) * sizeof(double));
  }

  bool deflated_;
  BlockJacobi inverse_diagonal_;
  std::vector<double> residual_;
  std::vector<double> step_;
};

/// x := x_l from residual_; returns |x_l - x|.
double Picard::update(std::span<double> x) {
  inverse_diagonal_.apply(residual_, step_);
  const std::int64_t size = static_cast<std::int64_t>(x.size());
  if (deflated_) {
    // x - E E^T x is x without its mean; residual_ is free to keep the old x for the increment.
    std::copy(x.begin(), x.end(), residual_.begin());
    system_->project(x);
    parallel_for(size, [&](std::int64_t k) {
      const std::size_t i = index(k);
      x[i] += step_[i];
      step_[i] = x[i] - residual_[i];
    });
  } else {
    system_->project(step_);
    parallel_for(size, [&](std::int64_t k) {
      const std::size_t i = index(k);
      x[i] += step_[i];
    });
  }
  return options_.stopping == Stopping::increment ? system_->norm(step_) : 0.0;
}

Solver::Attempt Picard::attempt(std::span<const double> b, std::span<double> x, double tolerance) {
  Attempt result;
  const double goal = tolerance * system_->norm(b);
  double first = 0.0;
  while (true) {
    system_->apply(x, residual_);
    parallel_for(static_cast<std::int64_t>(x.size()), [&](std::int64_t k) {
      const std::size_t i = index(k);
      residual_[i] = b[i] - residual_[i];
    });
    system_->project(residual_);
    const double norm = system_->norm(residual_);
    if (result.iterations == 0) first = norm;
    if (!(norm <= growth_limit * first)) {
      result.failure =
          "the iteration diverges: the matrix is not positive definite, or has stiffness that "
          "block-Jacobi cannot damp; choose solver.name = \"pcg\"";
      return result;
    }
    if (options_.stopping == Stopping::residual && norm <= goal) break;
    if (result.iterations == iterations_left_) return result;
    ++result.iterations;
    const double increment = update(x);
    if (options_.stopping == Stopping::increment && increment < tolerance * system_->norm(x)) break;
    if (norm == 0.0) break;
  }
  result.ok = true;
  return result;
}

}  // namespace

std::unique_ptr<Solver> make_picard(const SolverOptions& options) {
  return std::make_unique<Picard>(options, false);
}

std::unique_ptr<Solver> make_picard_deflated(const SolverOptions& options) {
  return std::make_unique<Picard>(options, true);
}

}  // namespace odpd
