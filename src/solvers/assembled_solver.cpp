#include "odpd/solvers/assembled_solver.h"

#include <algorithm>
#include <cmath>

#include "odpd/core/error.h"
#include "odpd/core/timer.h"
#include "odpd/solvers/backends.h"
#include "odpd/solvers/preconditioner.h"

namespace odpd {

void AssembledSolver::set_up() {
  response_.clear();
  if (!system_->share().alone())
    throw SolverError(name() + ": needs the whole matrix on one rank: use pcg on several");
  require_definite_diagonal(*system_);
  const Stopwatch watch;
  const BlockCsr& a = system_->matrix();
  assembly_seconds_ = watch.seconds();
  null_translations_ = system_->translations_are_null() && system_->null_motions().empty();
  if (system_->null_motions().empty()) {
    set_up_matrix(a);
  } else {
    set_up_matrix(with_springs(a));
  }
}

/// A + sum_p A_pp e_p e_p^T. The p are pivots of the null space: no combination of null motions rests at all of them.
BlockCsr AssembledSolver::with_springs(const BlockCsr& a) const {
  BlockCsr regular = a;
  const std::size_t b = index(a.block);
  std::vector<std::vector<double>> motions = system_->null_space();
  for (; !motions.empty(); motions.pop_back()) {
    const std::vector<double>& u = motions.back();
    std::size_t p = 0;
    for (std::size_t i = 0; i < u.size(); ++i)
      if (std::abs(u[i]) > std::abs(u[p])) p = i;
    const auto row = a.column.begin() + a.start[p / b];
    const auto k = std::find(row, a.column.end(), static_cast<std::int32_t>(p / b));
    regular.value[index(k - a.column.begin()) * b * b + p % b * (b + 1)] *= 2.0;
    for (std::size_t other = 0; other + 1 < motions.size(); ++other) {
      const double part = motions[other][p] / u[p];
      for (std::size_t i = 0; i < u.size(); ++i) motions[other][i] -= part * u[i];
    }
  }
  return regular;
}

/// Solves A Z = E and inverts E^T Z.
Solver::Attempt AssembledSolver::find_response(double tolerance) {
  const Translations translations = system_->translations();
  const std::size_t count = index(translations.components);
  const std::size_t size = index(system_->size());
  std::vector<std::vector<double>> response;
  inverse_schur_.assign(count * count, 0.0);
  Attempt total;
  const std::int64_t budget = iterations_left_;
  for (std::size_t k = 0; k < count; ++k) {
    std::vector<double> unit(count, 0.0), translation(size, 0.0), z(size, 0.0);
    unit[k] = 1.0;
    translations.add(unit, translation);
    const Attempt one = attempt_free(translation, z, std::max(0.1 * tolerance, 1e-14));
    total.iterations += one.iterations;
    total.failure = one.failure;
    if (!one.ok) return total;
    iterations_left_ = budget - total.iterations;
    const std::vector<double> sum = translations.sums(z);
    for (std::size_t i = 0; i < count; ++i) inverse_schur_[i * count + k] = sum[i];
    response.push_back(std::move(z));
  }
  if (!invert_definite(inverse_schur_, translations.components)) {
    total.failure = not_definite;
    return total;
  }
  response_ = std::move(response);
  total.ok = true;
  return total;
}

/// x -= Z (E^T Z)^-1 E^T x.
void AssembledSolver::hold_centre(std::span<double> x) const {
  const std::vector<double> sum = system_->translations().sums(x);
  for (std::size_t k = 0; k < sum.size(); ++k) {
    double force = 0.0;
    for (std::size_t j = 0; j < sum.size(); ++j)
      force += inverse_schur_[k * sum.size() + j] * sum[j];
    const std::vector<double>& z = response_[k];
    for (std::size_t i = 0; i < x.size(); ++i) x[i] -= force * z[i];
  }
}

Solver::Attempt AssembledSolver::attempt(std::span<const double> b, std::span<double> x,
                                         double tolerance) {
  if (!system_->holds_centre_of_mass()) {
    if (system_->null_motions().empty()) return attempt_free(b, x, tolerance);
    // What the residual has along a null motion falls on one spring: up to so many times as much.
    const double spread = std::sqrt(static_cast<double>(system_->size()));
    const Attempt result = attempt_free(b, x, std::max(tolerance / spread, 1e-14));
    system_->project(x);
    return result;
  }
  const std::int64_t budget = iterations_left_;
  std::int64_t spent = 0;
  if (response_.empty()) {
    const Attempt response = find_response(tolerance);
    if (!response.ok) return response;
    spent = response.iterations;
  }
  iterations_left_ = budget - spent;
  Attempt result = attempt_free(b, x, tolerance);
  result.iterations += spent;
  if (result.ok) hold_centre(x);
  return result;
}

std::int64_t AssembledSolver::memory_bytes() const {
  const BlockCsr& a = system_->matrix();
  const std::size_t matrix =
      (a.start.size() + a.column.size()) * sizeof(std::int32_t) + a.value.size() * sizeof(double);
  const std::size_t response = response_.size() * index(system_->size()) * sizeof(double);
  return backend_bytes() + static_cast<std::int64_t>(matrix + response);
}

}  // namespace odpd
