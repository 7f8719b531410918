// SuiteSparse sparse Cholesky of the assembled matrix. Where translations are null, what they move of the last node is
// grounded (its rows and columns, the last of all, dropped); the mean is restored after the solve.
#include <cblas.h>
#include <cholmod.h>
#include <fmt/format.h>

#include <algorithm>

#include "odpd/core/index.h"
#include "odpd/core/timer.h"
#include "odpd/solvers/assembled_solver.h"
#include "odpd/solvers/backends.h"

namespace odpd {

namespace {

/// The workspace of CHOLMOD and the objects made in it.
class Workspace {
 public:
  Workspace() {
    cholmod_l_start(&common);
    common.print = 0;
    common.final_ll = 1;  // L L^T also in the simplicial case: L D L^T would accept an indefinite A
    common.quick_return_if_not_posdef = 1;
  }
  ~Workspace() {
    clear();
    cholmod_l_finish(&common);
  }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  void clear() {
    cholmod_l_free_factor(&factor, &common);
    cholmod_l_free_sparse(&matrix, &common);
    common.memory_usage = common.memory_inuse;  // the peak counts from here
  }

  cholmod_common common{};
  cholmod_sparse* matrix = nullptr;
  cholmod_factor* factor = nullptr;
};

class Cholesky : public AssembledSolver {
 public:
  explicit Cholesky(const SolverOptions& options) : AssembledSolver(options) {}

 private:
  void set_up_matrix(const BlockCsr& a) override;
  void copy(const BlockCsr& a);
  void factorise();
  Attempt attempt_free(std::span<const double> b, std::span<double> x, double tolerance) override;
  std::int64_t backend_bytes() const override {
    return static_cast<std::int64_t>(work_.common.memory_usage);
  }

  Workspace work_;
  std::int64_t size_ = 0;  // unknowns that are not grounded: the first ones
  std::string failure_;    // of the factorisation; empty when there is a factor
};

/// The lower triangle by columns, which is the upper one by rows.
void Cholesky::copy(const BlockCsr& a) {
  const std::int64_t b = a.block;
  // visit(k, i, first, last): of block k, row i of it, the entries [first, last) that are kept.
  const auto for_each_part = [&](const auto& begin_row, const auto& visit) {
    for (std::int64_t unknown = 0; unknown < size_; ++unknown) {
      const std::int64_t row = unknown / b, i = unknown % b;
      begin_row(unknown);
      for (std::int32_t k = a.start[index(row)]; k < a.start[index(row) + 1]; ++k) {
        const std::int64_t column = a.column[index(k)];
        if (column >= row) visit(k, i, column == row ? i : 0, std::min(b, size_ - column * b));
      }
    }
  };
  std::int64_t entries = 0;
  for_each_part([](std::int64_t) {}, [&](std::int32_t, std::int64_t, std::int64_t first,
                                         std::int64_t last) { entries += last - first; });
  work_.matrix = cholmod_l_allocate_sparse(index(size_), index(size_), index(entries), true, true,
                                           -1, CHOLMOD_REAL, &work_.common);
  if (work_.matrix == nullptr) return;
  auto* const start = static_cast<SuiteSparse_long*>(work_.matrix->p);
  auto* const place = static_cast<SuiteSparse_long*>(work_.matrix->i);
  auto* const value = static_cast<double*>(work_.matrix->x);
  std::size_t at = 0;
  for_each_part([&](std::int64_t unknown) { start[unknown] = static_cast<SuiteSparse_long>(at); },
                [&](std::int32_t k, std::int64_t i, std::int64_t first, std::int64_t last) {
                  for (std::int64_t j = first; j < last; ++j, ++at) {
                    place[at] = a.column[index(k)] * b + j;
                    value[at] = a.value[index(k * b * b + i * b + j)];
                  }
                });
  start[size_] = static_cast<SuiteSparse_long>(at);
}

void Cholesky::factorise() {
  work_.factor = cholmod_l_analyze(work_.matrix, &work_.common);
  if (work_.factor != nullptr) cholmod_l_factorize(work_.matrix, work_.factor, &work_.common);
  const int status = work_.common.status;
  const bool broke_down = work_.factor != nullptr && work_.factor->minor < work_.factor->n;
  if (status == CHOLMOD_NOT_POSDEF || (status >= CHOLMOD_OK && broke_down)) {
    failure_ = not_definite;
  } else if (status == CHOLMOD_OUT_OF_MEMORY || status == CHOLMOD_TOO_LARGE) {
    failure_ = "the Cholesky factor does not fit into memory: choose solver.name = \"pcg\"";
  } else if (status < CHOLMOD_OK || work_.factor == nullptr) {
    failure_ = fmt::format("CHOLMOD failed with status {}: choose solver.name = \"pcg\"", status);
  }
}

void Cholesky::set_up_matrix(const BlockCsr& a) {
  openblas_set_num_threads(1);  // the same bits whatever the machine, and no threads inside threads
  work_.clear();
  failure_.clear();
  size_ = system_->size();
  if (null_translations_) size_ -= system_->translations().components;
  if (size_ <= 0) return;  // a single free node does not move
  const Stopwatch watch;
  copy(a);
  assembly_seconds_ += watch.seconds();
  if (work_.matrix == nullptr) {
    failure_ = "the matrix does not fit into memory: choose solver.name = \"pcg\"";
    return;
  }
  factorise();
  if (!failure_.empty()) cholmod_l_free_factor(&work_.factor, &work_.common);
  cholmod_l_free_sparse(&work_.matrix, &work_.common);
}

Solver::Attempt Cholesky::attempt_free(std::span<const double> b, std::span<double> x, double) {
  Attempt result;
  result.failure = failure_;
  if (!failure_.empty()) return result;
  result.iterations = 1;
  std::fill(x.begin(), x.end(), 0.0);
  if (size_ > 0) {
    const std::size_t size = work_.factor->n;
    cholmod_dense* load = cholmod_l_allocate_dense(size, 1, size, CHOLMOD_REAL, &work_.common);
    if (load != nullptr) std::copy_n(b.data(), size, static_cast<double*>(load->x));
    cholmod_dense* solution =
        load == nullptr ? nullptr : cholmod_l_solve(CHOLMOD_A, work_.factor, load, &work_.common);
    if (solution != nullptr) std::copy_n(static_cast<double*>(solution->x), size, x.data());
    result.ok = solution != nullptr;
    cholmod_l_free_dense(&load, &work_.common);
    cholmod_l_free_dense(&solution, &work_.common);
    if (!result.ok)
      result.failure =
          "no memory left to solve with the Cholesky factor: choose solver.name = \"pcg\"";
  } else {
    result.ok = true;
  }
  if (null_translations_) system_->project(x);
  return result;
}

}  // namespace

std::unique_ptr<Solver> make_cholmod(const SolverOptions& options) {
  return std::make_unique<Cholesky>(options);
}

}  // namespace odpd
