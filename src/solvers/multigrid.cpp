#include "odpd/solvers/multigrid.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "multilevel_kernels.h"
#include "odpd/core/error.h"
#include "odpd/core/index.h"

namespace odpd {

namespace {

// Up to so many unknowns the grid is not coarsened further.
constexpr std::int64_t dense_unknowns = 100;
// Of the largest diagonal entry, added to the coarsest operator: its entries are sums in single precision, so that where
// it is singular it may be indefinite by their rounding.
constexpr double dense_regularisation = 1e-7;

}  // namespace

template <int D>
Multigrid<D>::Level::Level(GridOperator<D> operator_of_level) : a(std::move(operator_of_level)) {
  for (FloatArray* v : {&b, &x, &r, &direction, &work}) {
    v->resize(D * a.shape().pitch());
    v->fill(0.0F);
  }
}

template <int D>
void Multigrid<D>::set_up(GridOperator<D> finest, bool null_translations) {
  levels_.clear();
  finest.set_up_smoother();
  levels_.emplace_back(std::move(finest));
  for (;;) {
    const GridOperator<D>& last = levels_.back().a;
    const GridShape<D>& shape = last.shape();
    if (shape.points() * D <= dense_unknowns || shape.coarser().cells == shape.cells) break;
    GridOperator<D> coarse = last.coarsened();
    coarse.set_up_smoother();
    levels_.emplace_back(std::move(coarse));
  }
  null_translations_ = null_translations;
  set_up_dense();
}

template <int D>
void Multigrid<D>::set_up_dense() {
  const GridOperator<D>& a = levels_.back().a;
  const GridShape<D>& shape = a.shape();
  dense_points_.clear();
  std::vector<std::int64_t> number(index(shape.total()), -1);
  for_each_point(shape, [&](const auto& point) {
    const std::int64_t n = shape.number_of(point);
    const float* const centre = a.block(n, GridShape<D>::entries / 2);
    double trace = 0.0;
    int k = 0;
    for (int row = 0; row < D; ++row)
      for (int col = row; col < D; ++col, ++k)
        if (row == col) trace += static_cast<double>(centre[k * 16]);
    if (!(trace > 0.0)) return;  // no particle near it
    number[index(n)] = static_cast<std::int64_t>(dense_points_.size());
    dense_points_.push_back(n);
  });
  const auto n = static_cast<Eigen::Index>(dense_points_.size()) * D;
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(n, n);
  for_each_point(shape, [&](const auto& point) {
    const std::int64_t row_number = number[index(shape.number_of(point))];
    if (row_number < 0) return;
    for (int entry = 0; entry < GridShape<D>::entries; ++entry) {
      auto other = point;
      bool inside = true;
      for (int c = 0, digits = entry; c < D; ++c, digits /= 3) {
        const auto i = index(c);
        other[i] += digits % 3 - 1;
        if (shape.periodic[i])
          other[i] = (other[i] + shape.points(c)) % shape.points(c);
        else
          inside = inside && other[i] >= 0 && other[i] < shape.points(c);
      }
      if (!inside) continue;
      const std::int64_t col_number = number[index(shape.number_of(other))];
      if (col_number < 0) continue;
      const float* const block = a.block(shape.number_of(point), entry);
      int k = 0;
      for (int row = 0; row < D; ++row)
        for (int col = row; col < D; ++col, ++k) {
          m(row_number * D + row, col_number * D + col) += static_cast<double>(block[k * 16]);
          if (col != row)
            m(row_number * D + col, col_number * D + row) += static_cast<double>(block[k * 16]);
        }
    }
  });
  m = (0.5 * (m + m.transpose())).eval();
  const double largest = n > 0 ? m.diagonal().maxCoeff() : 1.0;
  m.diagonal().array() += dense_regularisation * largest;
  if (null_translations_)
    for (Eigen::Index row = 0; row < n; ++row)
      for (Eigen::Index col = row % D; col < n; col += D)
        m(row, col) += largest * D / static_cast<double>(n);
  Eigen::LLT<Eigen::MatrixXd> factor(m);
  for (double more = dense_regularisation; factor.info() != Eigen::Success && more < 1.0;
       more *= 10.0) {
    m.diagonal().array() += 10.0 * more * largest;
    factor.compute(m);
  }
  if (factor.info() != Eigen::Success)
    throw SolverError("multilevel: the coarsest operator is not finite");
  const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(n, n));
  dense_inverse_.resize(n * n);
  dense_b_.resize(n);
  dense_x_.resize(n);
  for (Eigen::Index row = 0; row < n; ++row)
    for (Eigen::Index col = 0; col < n; ++col)
      dense_inverse_.data()[row * n + col] =
          static_cast<float>(0.5 * (inverse(row, col) + inverse(col, row)));
}

template <int D>
void Multigrid<D>::solve_dense() {
  Level& level = levels_.back();
  const GridShape<D>& shape = level.a.shape();
  const std::int64_t n = dense_b_.size();
  const auto at = [&](FloatArray& v, std::size_t k, int c) -> float& {
    return v.data()[shape.margin() + c * shape.pitch() + dense_points_[k]];
  };
  for (std::size_t k = 0; k < dense_points_.size(); ++k)
    for (int c = 0; c < D; ++c)
      dense_b_.data()[static_cast<std::int64_t>(k) * D + c] = at(level.b, k, c);
  multilevel_kernels().dense(dense_inverse_.data(), n, dense_b_.data(), dense_x_.data());
  for (std::size_t k = 0; k < dense_points_.size(); ++k)
    for (int c = 0; c < D; ++c)
      at(level.x, k, c) = dense_x_.data()[static_cast<std::int64_t>(k) * D + c];
}

/// b of the coarser level: P^T r.
template <int D>
void Multigrid<D>::restrict_residual(std::size_t level) {
  Level& fine = levels_[level];
  Level& coarse = levels_[level + 1];
  const GridShape<D>& f = fine.a.shape();
  const GridShape<D>& s = coarse.a.shape();
  fine.a.fill_ghosts(fine.r.data());
  for_each_point(s, [&](const auto& point) {
    std::array<std::int64_t, 27> offset{};
    std::array<float, 27> weight{1.0F};
    std::size_t count = 1;
    auto centre = point;
    for (int c = 0; c < D; ++c) {
      const auto i = index(c);
      if (!f.coarsened(c)) continue;
      centre[i] = 2 * point[i];
      const std::size_t before = count;
      for (const int side : {-1, 1}) {
        if (!f.periodic[i] && (centre[i] + side < 0 || centre[i] + side >= f.points(c))) continue;
        for (std::size_t k = 0; k < before; ++k, ++count) {
          offset[count] = offset[k] + side * f.stride(c);
          weight[count] = 0.5F * weight[k];
        }
      }
    }
    const std::int64_t from = f.margin() + f.number_of(centre),
                       into = s.margin() + s.number_of(point);
    for (int c = 0; c < D; ++c) {
      const float* const r = fine.r.data() + from + c * f.pitch();
      float sum = 0.0F;
      for (std::size_t k = 0; k < count; ++k) sum += weight[k] * r[offset[k]];
      coarse.b.data()[into + c * s.pitch()] = sum;
    }
  });
}

/// x += P x of the coarser level.
template <int D>
void Multigrid<D>::add_correction(std::size_t level) {
  Level& fine = levels_[level];
  Level& coarse = levels_[level + 1];
  const GridShape<D>& f = fine.a.shape();
  const GridShape<D>& s = coarse.a.shape();
  coarse.a.fill_ghosts(coarse.x.data());
  for_each_point(f, [&](const auto& point) {
    std::array<std::int64_t, 8> offset{};
    std::size_t count = 1;
    float weight = 1.0F;
    auto lower = point;
    for (int c = 0; c < D; ++c) {
      const auto i = index(c);
      if (!f.coarsened(c)) continue;
      lower[i] = point[i] / 2;
      if (point[i] % 2 == 0) continue;
      weight *= 0.5F;
      for (std::size_t k = 0; k < count; ++k) offset[count + k] = offset[k] + s.stride(c);
      count *= 2;
    }
    const std::int64_t from = s.margin() + s.number_of(lower),
                       into = f.margin() + f.number_of(point);
    for (int c = 0; c < D; ++c) {
      const float* const x = coarse.x.data() + from + c * s.pitch();
      float sum = 0.0F;
      for (std::size_t k = 0; k < count; ++k) sum += x[offset[k]];
      fine.x.data()[into + c * f.pitch()] += weight * sum;
    }
  });
}

template <int D>
void Multigrid<D>::cycle(std::size_t level) {
  if (level + 1 == levels_.size()) return solve_dense();
  Level& l = levels_[level];
  l.a.smooth_from_zero(l.b.data(), l.x.data(), l.direction.data(), l.work.data());
  l.a.residual(l.b.data(), l.x.data(), l.r.data());
  restrict_residual(level);
  cycle(level + 1);
  add_correction(level);
  l.a.smooth(l.b.data(), l.x.data(), l.direction.data(), l.work.data());
}

template <int D>
void Multigrid<D>::cycle() {
  cycle(0);
  finest().fill_ghosts(levels_.front().x.data());
}

template <int D>
std::int64_t Multigrid<D>::bytes() const {
  std::int64_t floats = dense_inverse_.size();
  std::int64_t sum = 0;
  for (const Level& level : levels_) {
    sum += level.a.bytes();
    floats += 5 * level.b.size();
  }
  return sum + floats * static_cast<std::int64_t>(sizeof(float));
}

template class Multigrid<2>;
template class Multigrid<3>;

}  // namespace odpd
