#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "multilevel_kernels.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/solvers/multigrid.h"
#include "odpd/solvers/preconditioner.h"

namespace odpd {

namespace {

constexpr int group = 16;
// Blocks of points with few particles around may be singular: a little more than themselves is inverted.
constexpr double regularisation = 1e-4;
// Chebyshev smoothing takes care of the eigenvalues of D^-1 A between this fraction of the largest and the largest.
constexpr double smoothed_fraction = 0.25;
constexpr int power_iterations = 10;
constexpr double power_safety = 1.1;  // the power iteration comes from below

template <int D>
StencilView view(const GridShape<D>& shape, const FloatArray& blocks, const FloatArray& inverse) {
  StencilView v{};
  v.blocks = blocks.data();
  v.inverse = inverse.data();
  v.pitch = shape.pitch();
  for (int k = 0; k < GridShape<D>::entries; ++k) v.offset[k] = shape.entry_offset(k);
  return v;
}

// body(first, last) over all groups, on all threads where that is worth the trouble.
template <int D, class Body>
void for_groups(const GridShape<D>& shape, const Body& body) {
  constexpr std::int64_t piece = 64;
  const std::int64_t groups = shape.groups();
  if (groups < 2 * piece) return body(std::int64_t{0}, groups);
  parallel_blocks((groups + piece - 1) / piece,
                  [&](std::int64_t k) { body(k * piece, std::min(groups, (k + 1) * piece)); });
}

}  // namespace

template <int D>
GridOperator<D>::GridOperator(const GridShape<D>& shape) : shape_(shape) {
  blocks_.resize(shape.groups() * GridShape<D>::entries * GridShape<D>::triangle * group);
  blocks_.fill(0.0F);
  inverse_.resize(shape.groups() * GridShape<D>::triangle * group);
  inverse_.fill(0.0F);
}

template <int D>
const float* GridOperator<D>::block(std::int64_t n, int entry) const {
  return blocks_.data() +
         ((n / group) * GridShape<D>::entries + entry) * GridShape<D>::triangle * group + n % group;
}

template <int D>
float* GridOperator<D>::block(std::int64_t n, int entry) {
  return const_cast<float*>(std::as_const(*this).block(n, entry));
}

template <int D>
std::int64_t GridOperator<D>::bytes() const {
  return (blocks_.size() + inverse_.size()) * static_cast<std::int64_t>(sizeof(float));
}

template <int D>
void GridOperator<D>::set_up_smoother() {
  for_each_point(shape_, [&](const auto& point) {
    const std::int64_t n = shape_.number_of(point);
    const float* const centre = block(n, GridShape<D>::entries / 2);
    std::array<double, index(D * D)> m{};
    double trace = 0.0;
    int k = 0;
    for (std::size_t row = 0; row < D; ++row)
      for (std::size_t col = row; col < D; ++col, ++k)
        m[row * D + col] = m[col * D + row] = static_cast<double>(centre[k * group]);
    for (std::size_t row = 0; row < D; ++row) trace += m[row * D + row];
    for (std::size_t row = 0; row < D; ++row) m[row * D + row] += regularisation * trace / D;
    if (!(trace > 0.0) || !invert_definite(m, D)) return;
    float* const inverse =
        inverse_.data() + (n / group) * GridShape<D>::triangle * group + n % group;
    k = 0;
    for (std::size_t row = 0; row < D; ++row)
      for (std::size_t col = row; col < D; ++col, ++k)
        inverse[k * group] = static_cast<float>(m[row * D + col]);
  });
  // Chebyshev iteration of two steps on [a, b] (Saad 2003, alg. 12.1).
  const double b = power_safety * largest_eigenvalue(), a = smoothed_fraction * b;
  const double theta = 0.5 * (a + b), delta = 0.5 * (b - a), sigma = theta / delta;
  const double rho = 1.0 / (2.0 * sigma - 1.0 / sigma);
  steps_[0] = {0.0F, static_cast<float>(1.0 / theta)};
  steps_[1] = {static_cast<float>(rho / sigma), static_cast<float>(2.0 * rho / delta)};
}

/// Of D^-1 A, by power iteration from a fixed start.
template <int D>
double GridOperator<D>::largest_eigenvalue() const {
  FloatArray x, d, y, zero;
  for (FloatArray* v : {&x, &d, &y, &zero}) {
    v->resize(D * shape_.pitch());
    v->fill(0.0F);
  }
  for_each_point(shape_, [&](const auto& point) {
    const std::int64_t n = shape_.number_of(point);
    for (int c = 0; c < D; ++c)
      first(x.data())[c * shape_.pitch() + n] =
          static_cast<float>(std::sin(static_cast<double>(1 + n * D + c) * 12.9898));
  });
  double largest = 1.0;
  for (int k = 0; k < power_iterations; ++k) {
    fill_ghosts(x.data());
    relax(x.data(), zero.data(), d.data(), y.data(), {0.0F, -1.0F});
    double before = 0.0, after = 0.0;
    for_each_point(shape_, [&](const auto& point) {
      const std::int64_t n = shape_.number_of(point);
      for (int c = 0; c < D; ++c) {
        const auto at = c * shape_.pitch() + n;
        before +=
            static_cast<double>(first(x.data())[at]) * static_cast<double>(first(x.data())[at]);
        after +=
            static_cast<double>(first(d.data())[at]) * static_cast<double>(first(d.data())[at]);
      }
    });
    if (!(before > 0.0) || !(after > 0.0)) break;
    largest = std::sqrt(after / before);
    const auto scale = static_cast<float>(1.0 / std::sqrt(after));
    for (std::int64_t i = 0; i < x.size(); ++i) x.data()[i] = scale * d.data()[i];
  }
  return largest;
}

template <int D>
void GridOperator<D>::fill_ghosts(float* vector) const {
  for (int component = 0; component < D; ++component) {
    float* const x = first(vector) + component * shape_.pitch();
    for (int c = 0; c < D; ++c) {
      if (!shape_.periodic[index(c)]) continue;
      // Runs of `below` consecutive places, one per line of this direction; the lower directions have their ghosts already.
      const std::int64_t below = shape_.stride(c);
      const std::int64_t line = below * (shape_.points(c) + 2);
      for (std::int64_t begin = 0; begin < shape_.total(); begin += line) {
        std::copy_n(x + begin + below * shape_.points(c), below, x + begin);
        std::copy_n(x + begin + below, below, x + begin + below * (shape_.points(c) + 1));
      }
    }
  }
}

template <int D>
void GridOperator<D>::relax(const float* x, const float* b, float* direction, float* y,
                            const Step& step) const {
  const StencilView v = view(shape_, blocks_, inverse_);
  for_groups(shape_, [&](std::int64_t begin, std::int64_t end) {
    multilevel_kernels().relax[D - 2](v, first(x), first(b), first(direction), first(y), step.keep,
                                      step.step, begin, end);
  });
}

template <int D>
void GridOperator<D>::smooth_from_zero(const float* b, float* x, float* direction,
                                       float* work) const {
  const StencilView v = view(shape_, blocks_, inverse_);
  for_groups(shape_, [&](std::int64_t begin, std::int64_t end) {
    multilevel_kernels().relax_zero[D - 2](v, first(b), first(direction), first(work),
                                           steps_[0].step, begin, end);
  });
  fill_ghosts(work);
  relax(work, b, direction, x, steps_[1]);
}

template <int D>
void GridOperator<D>::smooth(const float* b, float* x, float* direction, float* work) const {
  fill_ghosts(x);
  relax(x, b, direction, work, steps_[0]);
  fill_ghosts(work);
  relax(work, b, direction, x, steps_[1]);
}

template <int D>
void GridOperator<D>::residual(const float* b, float* x, float* r) const {
  fill_ghosts(x);
  const StencilView v = view(shape_, blocks_, inverse_);
  for_groups(shape_, [&](std::int64_t begin, std::int64_t end) {
    multilevel_kernels().residual[D - 2](v, first(x), first(b), first(r), begin, end);
  });
}

// One term of P^T A P: from a fine point's coupling with a neighbour to a coarse point's.
struct CoarseningPath {
  int neighbour, coarse;  // stencil entries
  float weight;
};

namespace {

/// For each of the 3^D fine points around a coarse one, what its couplings contribute.
template <int D>
std::vector<std::vector<CoarseningPath>> coarsening_paths(const GridShape<D>& shape) {
  std::vector<std::vector<CoarseningPath>> paths(index(GridShape<D>::entries));
  const auto side = [](int entry, int c) {
    for (; c > 0; --c) entry /= 3;
    return entry % 3 - 1;
  };
  for (int fine = 0; fine < GridShape<D>::entries; ++fine)
    for (int neighbour = 0; neighbour < GridShape<D>::entries; ++neighbour)
      for (int coarse = 0; coarse < GridShape<D>::entries; ++coarse) {
        float weight = 1.0F;
        for (int c = 0; c < D; ++c) {
          const bool halved = shape.coarsened(c);
          const auto hat = [halved](int distance) {
            if (!halved) return distance == 0 ? 1.0F : 0.0F;
            return std::max(0.0F, 1.0F - 0.5F * static_cast<float>(std::abs(distance)));
          };
          weight *= hat(side(fine, c)) *
                    hat(side(fine, c) + side(neighbour, c) - (halved ? 2 : 1) * side(coarse, c));
        }
        if (weight > 0.0F) paths[index(fine)].push_back({neighbour, coarse, weight});
      }
  return paths;
}

/// The number of the coarse point from which stencil entry `side` leads to a fine one; negative: there is none.
template <int D>
std::int64_t coarse_point(const GridShape<D>& shape, const GridShape<D>& coarse, int side,
                          const typename GridShape<D>::Index& fine) {
  std::int64_t number = 0, unit = 1;
  for (int c = 0; c < D; unit *= coarse.points(c), ++c, side /= 3) {
    std::int64_t x = fine[index(c)] - (side % 3 - 1);
    if (shape.coarsened(c)) {
      if (x % 2 != 0) return -1;
      x /= 2;
    }
    if (shape.periodic[index(c)])
      x = (x + coarse.points(c)) % coarse.points(c);
    else if (x < 0 || x >= coarse.points(c))
      return -1;
    number += unit * x;
  }
  return number;
}

}  // namespace

template <int D>
GridOperator<D> GridOperator<D>::coarsened() const {
  GridOperator coarse(shape_.coarser());
  const auto paths = coarsening_paths(shape_);
  // Triangles side by side and padded, so that a path is a vector operation.
  constexpr std::size_t entries = GridShape<D>::entries, triangle = GridShape<D>::triangle,
                        padded = D == 2 ? 4 : 8;
  using Stencil = std::array<std::array<float, padded>, entries>;
  std::vector<Stencil> sums(index(coarse.shape_.points()));
  Stencil from{};
  for_each_point(shape_, [&](const auto& fine) {
    const float* const blocks = block(shape_.number_of(fine), 0);
    for (std::size_t n = 0; n < entries; ++n)
      for (std::size_t k = 0; k < triangle; ++k) from[n][k] = blocks[(n * triangle + k) * group];
    for (std::size_t side = 0; side < entries; ++side) {
      if (paths[side].empty()) continue;
      const std::int64_t number = coarse_point(shape_, coarse.shape_, static_cast<int>(side), fine);
      if (number < 0) continue;
      Stencil& sum = sums[index(number)];
      for (const CoarseningPath& path : paths[side]) {
        const auto& a = from[index(path.neighbour)];
        auto& b = sum[index(path.coarse)];
        for (std::size_t k = 0; k < padded; ++k) b[k] += path.weight * a[k];
      }
    }
  });
  std::size_t number = 0;
  for_each_point(coarse.shape_, [&](const auto& point) {
    const Stencil& sum = sums[number++];
    float* const into = coarse.block(coarse.shape_.number_of(point), 0);
    for (std::size_t n = 0; n < entries; ++n)
      for (std::size_t k = 0; k < triangle; ++k) into[(n * triangle + k) * group] = sum[n][k];
  });
  return coarse;
}

template class GridOperator<2>;
template class GridOperator<3>;

}  // namespace odpd
