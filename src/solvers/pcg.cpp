// Preconditioned conjugate gradients. On velocities of particles, bodies and spins of particles, the work is done in single
// precision (mixed_cg.cpp); on any other System, whatever its block, and where single precision does not do, in double, on
// System::apply. On a projected system everything lives in the range of Pi: the operator is Pi A Pi, the preconditioner
// Pi M^-1 Pi.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "cg_engine.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/solvers/backends.h"
#include "odpd/solvers/preconditioner.h"

namespace odpd {

namespace {

constexpr const char* no_grid =
    "preconditioner multilevel is for velocities of particles and rigid bodies and for spins of "
    "particles, not for these unknowns: block-Jacobi in double precision instead";

class DoubleCg : public CgEngine {
 public:
  bool serves(const System&) const override { return true; }
  void set_up(const System& system) override {
    system_ = &system;
    preconditioner_.set_up(system);
    for (auto* v : {&r_, &z_, &p_, &q_}) v->resize(index(system.size()));
  }
  Solver::Attempt attempt(std::span<const double> b, std::span<double> x, double tolerance,
                          std::int64_t most_iterations) override;
  std::int64_t memory_bytes() const override {
    return preconditioner_.memory_bytes() +
           static_cast<std::int64_t>(4 * r_.size() * sizeof(double));
  }

 private:
  void cycle(std::span<double> x, double goal, std::int64_t most_iterations,
             Solver::Attempt& result);
  double start(std::span<const double> b, std::span<const double> x);

  const System* system_ = nullptr;
  BlockJacobi preconditioner_;
  std::vector<double> r_, z_, p_, q_;
};

/// r := Pi (b - A x), the true residual; returns its norm.
double DoubleCg::start(std::span<const double> b, std::span<const double> x) {
  system_->apply(x, r_);
  parallel_for(system_->size(), [&](std::int64_t i) { r_[index(i)] = b[index(i)] - r_[index(i)]; });
  system_->project(r_);
  return system_->norm(r_);
}

/// Iterates until the recursive residual is below `goal`; sets ok, or leaves it and says why.
void DoubleCg::cycle(std::span<double> x, double goal, std::int64_t most_iterations,
                     Solver::Attempt& result) {
  const double first = system_->norm(r_);
  double rho_before = 0.0;
  while (result.iterations < most_iterations) {
    ++result.iterations;
    preconditioner_.apply(r_, z_);
    system_->project(z_);
    const double rho = system_->inner_product(r_, z_);
    const double beta = rho_before == 0.0 ? 0.0 : rho / rho_before;
    parallel_for(system_->size(),
                 [&](std::int64_t i) { p_[index(i)] = z_[index(i)] + beta * p_[index(i)]; });
    system_->apply(p_, q_);
    system_->project(q_);
    const double curvature = system_->inner_product(p_, q_);
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
    const double norm = system_->norm(r_);
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

Solver::Attempt DoubleCg::attempt(std::span<const double> b, std::span<double> x, double tolerance,
                                  std::int64_t most_iterations) {
  Solver::Attempt result;
  const double goal = tolerance * system_->norm(b);
  double norm = start(b, x);
  // The recursive residual drifts from the true one: start over from the true one while that helps.
  while (norm > goal) {
    std::fill(p_.begin(), p_.end(), 0.0);
    result.ok = false;
    cycle(x, goal, most_iterations, result);
    if (!result.ok) return result;
    const double before = norm;
    norm = start(b, x);
    if (!(norm < 0.5 * before)) break;
  }
  if (std::isnan(norm)) result.failure = no_longer_finite;
  result.ok = !std::isnan(norm);
  return result;
}

class ConjugateGradients : public Solver {
 public:
  explicit ConjugateGradients(const SolverOptions& options) : Solver(options) {}

  void save(StateWriter& out) const override {
    if (mixed_) mixed_->save(out);
  }
  void load(const StateReader& in, const System& system) override {
    choose_engine(system);
    if (mixed_) mixed_->load(in);
  }
  void remember(bool on) override {
    if (mixed_) mixed_->remember(on);
  }

 private:
  void set_up() override {
    choose_engine(*system_);
    note_.clear();
    in_double_ = mixed_ == nullptr;
    if (in_double_) {
      if (options_.preconditioner == "multilevel") note_ = no_grid;
      double_.set_up(*system_);
    } else {
      mixed_->set_up(*system_);
    }
  }
  // Kept from one bind to the next with what it remembers.
  void choose_engine(const System& system) {
    if (mixed_ == nullptr || !mixed_->serves(system)) mixed_ = make_mixed_cg(system, options_);
  }
  Attempt attempt(std::span<const double> b, std::span<double> x, double tolerance) override;
  std::int64_t memory_bytes() const override {
    return double_.memory_bytes() + (mixed_ ? mixed_->memory_bytes() : 0);
  }
  std::string note() const override { return note_; }

  std::unique_ptr<CgEngine> mixed_;  // null: the system has no rows of R
  DoubleCg double_;
  bool in_double_ = false;
  std::string note_;
};

// The last resort: what is too badly conditioned for single precision, about 1e7, is done in double, until the next bind.
Solver::Attempt ConjugateGradients::attempt(std::span<const double> b, std::span<double> x,
                                            double tolerance) {
  if (in_double_) return double_.attempt(b, x, tolerance, iterations_left_);
  const Attempt mixed = mixed_->attempt(b, x, tolerance, iterations_left_);
  note_ = mixed_->note();
  if (mixed.ok || mixed.failure.empty()) return mixed;
  note_ += (note_.empty() ? "" : "; ") +
           ("single precision gave up (" + mixed.failure + "): double precision instead");
  double_.set_up(*system_);
  in_double_ = true;
  Attempt last = double_.attempt(b, x, tolerance, iterations_left_ - mixed.iterations);
  last.iterations += mixed.iterations;
  return last;
}

}  // namespace

std::unique_ptr<Solver> make_pcg(const SolverOptions& options) {
  return std::make_unique<ConjugateGradients>(options);
}

}  // namespace odpd
