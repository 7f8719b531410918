#pragma once
// Systems whose unknowns per node are not the dimension of space, on the edges of a real pair network: a fluid of particles that
// spin, and conduction between particles. A = sum over edges of J^T Z J, with slip J (x_i, x_j) = J_i x_i + J_j x_j.
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "contract.h"
#include "odpd/core/rotation.h"
#include "odpd/operator/node_map.h"
#include "odpd/operator/system.h"

namespace contract {

/// A dense matrix, row-major.
struct Matrix {
  std::size_t rows = 0, columns = 0;
  std::vector<double> value = std::vector<double>(rows * columns, 0.0);
  double& operator()(std::size_t r, std::size_t c) { return value[r * columns + c]; }
  double operator()(std::size_t r, std::size_t c) const { return value[r * columns + c]; }
};

/// a^T z b.
inline Matrix product(const Matrix& a, const Matrix& z, const Matrix& b) {
  Matrix m{a.columns, b.columns};
  for (std::size_t k = 0; k < z.rows; ++k)
    for (std::size_t l = 0; l < z.columns; ++l)
      for (std::size_t r = 0; r < m.rows; ++r)
        for (std::size_t c = 0; c < m.columns; ++c) m(r, c) += a(k, r) * z(k, l) * b(l, c);
  return m;
}

struct CoupledEdge {
  std::array<std::size_t, 2> particle{};
  std::array<Matrix, 2> J;
  Matrix Z;
};

/// What is asked of a system besides its edges.
struct Asked {
  bool hold = false;
  int translated = 0;  ///< components that it says translations move
};

class EdgeSystem : public odpd::System {
 public:
  EdgeSystem(const std::vector<CoupledEdge>& edges, odpd::NodeMap map, int dimension,
             const Asked& asked)
      : map_(std::move(map)), dimension_(dimension), asked_(asked) {
    for (const CoupledEdge& e : edges)
      for (std::size_t a = 0; a < 2; ++a)
        for (std::size_t b = 0; b < 2; ++b) {
          const std::int32_t row = map_.node_of(e.particle[a]),
                             column = map_.node_of(e.particle[b]);
          if (row < 0) continue;
          anchored_ = anchored_ || column < 0;
          if (column >= 0) add(row, column, product(e.J[a], e.Z, e.J[b]));
        }
    assemble();
  }

  int block_size() const override { return map_.block_size(); }
  std::int64_t nodes() const override { return map_.nodes(); }
  odpd::Translations translations() const override {
    return {block_size(), nodes(), asked_.translated};
  }
  void apply(std::span<const double> x, std::span<double> y) const override {
    assembled_->apply(x, y);
  }
  void block_diagonal(std::span<double> blocks) const override {
    assembled_->block_diagonal(blocks);
  }
  const odpd::BlockCsr& matrix() const override { return assembled_->matrix(); }
  std::span<const double> positions() const override { return {}; }
  int space_dimension() const override { return dimension_; }
  int periodic_directions() const override { return dimension_; }
  bool translations_are_null() const override { return !anchored_; }
  bool holds_centre_of_mass() const override { return asked_.hold && anchored_; }
  std::uint64_t generation() const override { return 1; }
  odpd::Share share() const override { return share_; }
  /// As AssembledSystem::share_among.
  void share_among(const odpd::Communicator& ranks) { share_ = odpd::Share::of(ranks, nodes()); }

 private:
  void add(std::int32_t row, std::int32_t column, const Matrix& block) {
    std::vector<double>& sum = blocks_[{row, column}];
    sum.resize(block.value.size());
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += block.value[k];
  }
  void assemble() {
    odpd::BlockCsr matrix;
    matrix.block = block_size();
    matrix.rows = static_cast<std::int32_t>(nodes());
    matrix.start.assign(static_cast<std::size_t>(nodes()) + 1, 0);
    for (const auto& [place, block] : blocks_) {
      ++matrix.start[static_cast<std::size_t>(place.first) + 1];
      matrix.column.push_back(place.second);
      matrix.value.insert(matrix.value.end(), block.begin(), block.end());
    }
    for (std::size_t n = 1; n < matrix.start.size(); ++n) matrix.start[n] += matrix.start[n - 1];
    assembled_ = std::make_unique<odpd::AssembledSystem>(std::move(matrix));
  }

  odpd::NodeMap map_;
  int dimension_;
  Asked asked_;
  bool anchored_ = false;
  odpd::Share share_;
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<double>> blocks_;
  std::unique_ptr<odpd::AssembledSystem> assembled_;
};

/// Friction along and across each edge on the slip of two spheres at their point of contact,
/// v_i - v_j - (w_i + w_j) x r/2; blocks of spin, then velocity.
template <int D>
std::vector<CoupledEdge> spinning(const odpd::PairNetwork<D>& network) {
  constexpr std::size_t S = odpd::rotation_components<D>, B = S + D;
  std::vector<CoupledEdge> edges;
  for (std::size_t k = 0; k < network.i.size(); ++k) {
    CoupledEdge edge{
        {static_cast<std::size_t>(network.i[k]), static_cast<std::size_t>(network.j[k])},
        {Matrix{D, B}, Matrix{D, B}},
        Matrix{D, D}};
    for (int row = 0; row < D; ++row)
      for (int c = 0; c < D; ++c) {
        const double along = network.e[k][row] * network.e[k][c], unit = row == c ? 1.0 : 0.0;
        edge.Z(static_cast<std::size_t>(row), static_cast<std::size_t>(c)) =
            network.zeta_par[k] * along + network.zeta_perp[k] * (unit - along);
      }
    for (std::size_t s = 0; s < B; ++s) {
      odpd::Vec<D> unit{}, slip{};
      unit.x[s < S ? s : s - S] = 1.0;
      slip = s < S ? -0.5 * odpd::swing(unit, network.r[k] * network.e[k]) : unit;
      for (std::size_t c = 0; c < D; ++c) {
        edge.J[0](c, s) = slip.x[c];
        edge.J[1](c, s) = s < S ? slip.x[c] : -slip.x[c];
      }
    }
    edges.push_back(std::move(edge));
  }
  return edges;
}

/// Heat conduction with kappa = zeta_par: one number per particle.
template <int D>
std::vector<CoupledEdge> conducting(const odpd::PairNetwork<D>& network) {
  std::vector<CoupledEdge> edges;
  for (std::size_t k = 0; k < network.i.size(); ++k)
    edges.push_back(
        {{static_cast<std::size_t>(network.i[k]), static_cast<std::size_t>(network.j[k])},
         {Matrix{1, 1, {1.0}}, Matrix{1, 1, {-1.0}}},
         Matrix{1, 1, {network.zeta_par[k]}}});
  return edges;
}

/// x of  A x + E l = b, E^T x = 0  (without E where there are no translations to remove), by Gauss with pivots.
inline std::vector<double> dense_solution(const Matrix& a, const Matrix& E,
                                          const std::vector<double>& b) {
  const std::size_t n = b.size(), size = n + E.columns;
  Matrix m{size, size + 1};
  for (std::size_t r = 0; r < n; ++r) {
    for (std::size_t c = 0; c < n; ++c) m(r, c) = a(r, c);
    m(r, size) = b[r];
    for (std::size_t c = 0; c < E.columns; ++c) m(r, n + c) = m(n + c, r) = E(r, c);
  }
  for (std::size_t p = 0; p < size; ++p) {
    std::size_t best = p;
    for (std::size_t r = p; r < size; ++r)
      if (std::abs(m(r, p)) > std::abs(m(best, p))) best = r;
    for (std::size_t c = p; c <= size; ++c) std::swap(m(p, c), m(best, c));
    for (std::size_t r = p + 1; r < size; ++r) {
      const double factor = m(r, p) / m(p, p);
      if (factor == 0.0) continue;
      for (std::size_t c = p; c <= size; ++c) m(r, c) -= factor * m(p, c);
    }
  }
  for (std::size_t p = size; p-- > 0;) {
    for (std::size_t c = p + 1; c < size; ++c) m(p, size) -= m(p, c) * m(c, size);
    m(p, size) /= m(p, p);
  }
  std::vector<double> x(n);
  for (std::size_t r = 0; r < n; ++r) x[r] = m(r, size);
  return x;
}

inline std::vector<double> dense_solution(const std::vector<CoupledEdge>& edges,
                                          const odpd::NodeMap& map, const Matrix& E,
                                          const std::vector<double>& b) {
  const auto block = static_cast<std::size_t>(map.block_size());
  Matrix m{b.size(), b.size()};
  for (const CoupledEdge& e : edges)
    for (std::size_t a = 0; a < 2; ++a)
      for (std::size_t c = 0; c < 2; ++c) {
        const std::int32_t row = map.node_of(e.particle[a]), column = map.node_of(e.particle[c]);
        if (row < 0 || column < 0) continue;
        const Matrix part = product(e.J[a], e.Z, e.J[c]);
        for (std::size_t k = 0; k < block * block; ++k)
          m(static_cast<std::size_t>(row) * block + k / block,
            static_cast<std::size_t>(column) * block + k % block) += part.value[k];
      }
  return dense_solution(m, E, b);
}

}  // namespace contract
