// Eigen::ConjugateGradient on the assembled matrix, preconditioned by its diagonal.
#include <fmt/format.h>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <limits>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/core/timer.h"
#include "odpd/solvers/assembled_solver.h"
#include "odpd/solvers/backends.h"

namespace odpd::eigen {

using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;
class WatchedMatrix;

}  // namespace odpd::eigen

namespace Eigen::internal {
template <>
struct traits<odpd::eigen::WatchedMatrix> : traits<odpd::eigen::Sparse> {};
}  // namespace Eigen::internal

namespace odpd::eigen {

/// Thrown out of Eigen's iteration, which does not look at the sign of p^T A p.
struct Indefinite {};

/// A sparse matrix that checks p^T A p >= 0 in each product A p.
class WatchedMatrix : public Eigen::EigenBase<WatchedMatrix> {
 public:
  using Scalar = double;
  using RealScalar = double;
  using StorageIndex = int;
  enum {
    ColsAtCompileTime = Eigen::Dynamic,
    MaxColsAtCompileTime = Eigen::Dynamic,
    RowsAtCompileTime = Eigen::Dynamic,
    IsRowMajor = true
  };
  struct InnerIterator : Sparse::InnerIterator {
    InnerIterator(const WatchedMatrix& a, Eigen::Index outer)
        : Sparse::InnerIterator(a.sparse(), outer) {}
  };

  Sparse& sparse() { return sparse_; }
  const Sparse& sparse() const { return sparse_; }
  Eigen::Index rows() const { return sparse_.rows(); }
  Eigen::Index cols() const { return sparse_.cols(); }
  Eigen::Index outerSize() const { return sparse_.outerSize(); }
  template <class Right>
  Eigen::Product<WatchedMatrix, Right, Eigen::AliasFreeProduct> operator*(
      const Eigen::MatrixBase<Right>& p) const {
    return {*this, p.derived()};
  }

 private:
  Sparse sparse_;
};

}  // namespace odpd::eigen

namespace Eigen::internal {

template <class Right>
struct generic_product_impl<odpd::eigen::WatchedMatrix, Right, SparseShape, DenseShape, GemvProduct>
    : generic_product_impl_base<odpd::eigen::WatchedMatrix, Right,
                                generic_product_impl<odpd::eigen::WatchedMatrix, Right>> {
  template <class Result>
  static void scaleAndAddTo(Result& result, const odpd::eigen::WatchedMatrix& a, const Right& p,
                            double scale) {
    const VectorXd product = a.sparse() * p;
    if (!(p.dot(product) >= 0.0)) throw odpd::eigen::Indefinite{};
    result += scale * product;
  }
};

}  // namespace Eigen::internal

namespace odpd {

namespace {

class EigenConjugateGradients : public AssembledSolver {
 public:
  explicit EigenConjugateGradients(const SolverOptions& options) : AssembledSolver(options) {}

 private:
  void set_up_matrix(const BlockCsr& a) override;
  Attempt attempt_free(std::span<const double> b, std::span<double> x, double tolerance) override;
  std::int64_t backend_bytes() const override {
    const std::int64_t matrix =
        matrix_.sparse().nonZeros() * static_cast<std::int64_t>(sizeof(double) + sizeof(int));
    return matrix + 6 * matrix_.rows() * static_cast<std::int64_t>(sizeof(double));
  }

  eigen::WatchedMatrix matrix_;
  Eigen::ConjugateGradient<eigen::WatchedMatrix, Eigen::Lower | Eigen::Upper> iteration_;
};

void EigenConjugateGradients::set_up_matrix(const BlockCsr& a) {
  const Stopwatch watch;
  if (a.value.size() > index(std::numeric_limits<int>::max())) {
    throw SolverError(
        fmt::format("eigen-cg cannot index {} matrix entries: choose solver.name = "
                    "\"pcg\"",
                    a.value.size()));
  }
  eigen::Sparse& sparse = matrix_.sparse();
  const int b = a.block;
  sparse.resize(a.rows * b, a.rows * b);
  sparse.resizeNonZeros(static_cast<Eigen::Index>(a.value.size()));
  int at = 0;
  for (std::int32_t row = 0; row < a.rows; ++row) {
    for (int i = 0; i < b; ++i) {
      sparse.outerIndexPtr()[row * b + i] = at;
      for (std::int32_t k = a.start[index(row)]; k < a.start[index(row) + 1]; ++k) {
        for (int j = 0; j < b; ++j, ++at) {
          sparse.innerIndexPtr()[at] = a.column[index(k)] * b + j;
          sparse.valuePtr()[at] = a.value[index(k) * index(b * b) + index(i * b + j)];
        }
      }
    }
  }
  sparse.outerIndexPtr()[a.rows * b] = at;
  assembly_seconds_ += watch.seconds();
  iteration_.compute(matrix_);
}

Solver::Attempt EigenConjugateGradients::attempt_free(std::span<const double> b,
                                                      std::span<double> x, double tolerance) {
  const Eigen::Map<const Eigen::VectorXd> load(b.data(), static_cast<Eigen::Index>(b.size()));
  Eigen::Map<Eigen::VectorXd> solution(x.data(), static_cast<Eigen::Index>(x.size()));
  Eigen::setNbThreads(threads());
  iteration_.setTolerance(tolerance);
  iteration_.setMaxIterations(iterations_left_);
  Attempt result;
  try {
    solution = iteration_.solveWithGuess(load, Eigen::VectorXd(solution));
  } catch (const eigen::Indefinite&) {
    result.failure = not_definite;
    return result;
  }
  result.iterations = iteration_.iterations();
  result.ok = iteration_.info() == Eigen::Success;
  return result;
}

}  // namespace

std::unique_ptr<Solver> make_eigen_cg(const SolverOptions& options) {
  return std::make_unique<EigenConjugateGradients>(options);
}

}  // namespace odpd
