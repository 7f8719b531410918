#include "odpd/operator/resistance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "odpd/core/error.h"
#include "odpd/core/parallel.h"

namespace odpd {

namespace {

template <int D>
Vec<D> load(std::span<const double> x, std::size_t node) {
  Vec<D> v;
  for (int c = 0; c < D; ++c) v[c] = x[node * D + static_cast<std::size_t>(c)];
  return v;
}

// Determinant of a symmetric positive semidefinite D x D block relative to the largest it could have with its
// trace: 1 for an isotropic block, 0 for a singular one.
template <int D>
double relative_determinant(const double* block) {
  std::array<double, D * D> m;
  std::copy(block, block + D * D, m.begin());
  double trace = 0.0;
  for (std::size_t c = 0; c < D; ++c) trace += m[c * D + c];
  double det = 1.0;
  for (std::size_t p = 0; p < D; ++p) {
    const double pivot = m[p * D + p];
    if (!(pivot > 0.0)) return 0.0;
    det *= pivot * D / trace;
    for (std::size_t row = p + 1; row < D; ++row)
      for (std::size_t col = p + 1; col < D; ++col)
        m[row * D + col] -= m[row * D + p] * m[p * D + col] / pivot;
  }
  return det;
}

}  // namespace

template <int D>
void Resistance<D>::rebuild(const PairNetwork<D>& network, const DofMap<D>& dofs,
                            const Particles<D>& particles, std::span<const Vec<D>> positions,
                            double shift) {
  nodes_ = dofs.nodes();
  shift_ = shift;
  ++generation_;
  start_.assign(static_cast<std::size_t>(nodes_) + 1, 0);
  for (std::size_t n = 0; n < static_cast<std::size_t>(nodes_); ++n)
    start_[n + 1] =
        start_[n] + static_cast<std::int64_t>(network.edges_of(dofs.particle_of(n)).size());
  entries_.resize(static_cast<std::size_t>(start_.back()));
  positions_.resize(static_cast<std::size_t>(nodes_) * D);
  parallel_for(nodes_, [&](std::int64_t node) {
    const auto n = static_cast<std::size_t>(node);
    const std::int32_t particle = dofs.particle_of(n);
    for (int c = 0; c < D; ++c)
      positions_[n * D + static_cast<std::size_t>(c)] =
          positions[static_cast<std::size_t>(particle)][c];
    auto slot = static_cast<std::size_t>(start_[n]);
    for (const std::int32_t edge : network.edges_of(particle)) {
      const auto k = static_cast<std::size_t>(edge);
      const std::int32_t other = network.i[k] == particle ? network.j[k] : network.i[k];
      const double along = network.zeta_par[k] - network.zeta_perp[k];
      Entry& entry = entries_[slot++];
      entry.g = std::sqrt(std::abs(along)) * network.e[k];
      entry.sign = along < 0.0 ? -1.0 : 1.0;
      entry.across = network.zeta_perp[k];
      entry.node = dofs.node_of(static_cast<std::size_t>(other));
    }
  });
  const bool anchored = std::any_of(entries_.begin(), entries_.end(), [](const Entry& entry) {
    return entry.node < 0 && (dot(entry.g, entry.g) > 0.0 || entry.across > 0.0);
  });
  translations_are_null_ = !anchored && shift == 0.0;
  if (shift == 0.0) check_rattlers(dofs, particles, shift);
}

template <int D>
void Resistance<D>::check_rattlers(const DofMap<D>& dofs, const Particles<D>& particles,
                                   double shift) const {
  std::vector<double> blocks(static_cast<std::size_t>(nodes_) * D * D);
  block_diagonal(blocks);
  // Below this a block inverse would amplify rounding beyond any tolerance in use.
  constexpr double singular = 1e-12;
  for (std::size_t n = 0; n < static_cast<std::size_t>(nodes_); ++n) {
    if (relative_determinant<D>(&blocks[n * D * D]) > singular) continue;
    const std::int64_t neighbours = start_[n + 1] - start_[n];
    throw SolverError(fmt::format(
        "particle {} is a rattler: its {} neighbour(s) within the cutoff leave it free to move in "
        "some direction "
        "without friction, so R (diagonal shift {}) is singular. Cures: a weak pairwise friction "
        "of longer range "
        "(fluid.rattler_friction = {{ gamma = 0.1, cutoff = 2.0 }}), a higher density or a larger "
        "cutoff, or mass",
        particles.id[static_cast<std::size_t>(dofs.particle_of(n))], neighbours, shift));
  }
}

template <int D>
void Resistance<D>::apply(std::span<const double> x, std::span<double> y) const {
  parallel_for(nodes_, [&](std::int64_t node) {
    const auto n = static_cast<std::size_t>(node);
    const Vec<D> xi = load<D>(x, n);
    Vec<D> sum = shift_ * xi;
    for (auto k = static_cast<std::size_t>(start_[n]); k < static_cast<std::size_t>(start_[n + 1]);
         ++k) {
      const Entry& entry = entries_[k];
      sum += stretch(entry,
                     entry.node < 0 ? xi : xi - load<D>(x, static_cast<std::size_t>(entry.node)));
    }
    for (int c = 0; c < D; ++c) y[n * D + static_cast<std::size_t>(c)] = sum[c];
  });
}

template <int D>
void Resistance<D>::block_diagonal(std::span<double> blocks) const {
  parallel_for(nodes_, [&](std::int64_t node) {
    const auto n = static_cast<std::size_t>(node);
    for (int col = 0; col < D; ++col) {
      Vec<D> unit{};
      unit[col] = 1.0;
      Vec<D> sum = shift_ * unit;
      for (auto k = static_cast<std::size_t>(start_[n]);
           k < static_cast<std::size_t>(start_[n + 1]); ++k)
        sum += stretch(entries_[k], unit);
      for (int row = 0; row < D; ++row)
        blocks[(n * D + static_cast<std::size_t>(row)) * D + static_cast<std::size_t>(col)] =
            sum[row];
    }
  });
}

template <int D>
const BlockCsr& Resistance<D>::matrix() const {
  if (matrix_generation_ == generation_) return matrix_;
  std::vector<double> diagonal(static_cast<std::size_t>(nodes_) * D * D);
  block_diagonal(diagonal);
  BlockCsr m;
  m.block = D;
  m.rows = static_cast<std::int32_t>(nodes_);
  m.start.assign(static_cast<std::size_t>(nodes_) + 1, 0);
  std::vector<const Entry*> row;
  for (std::size_t n = 0; n < static_cast<std::size_t>(nodes_); ++n) {
    row.clear();
    for (auto k = static_cast<std::size_t>(start_[n]); k < static_cast<std::size_t>(start_[n + 1]);
         ++k)
      if (entries_[k].node >= 0) row.push_back(&entries_[k]);
    std::stable_sort(row.begin(), row.end(),
                     [](const Entry* a, const Entry* b) { return a->node < b->node; });
    const auto self = static_cast<std::int32_t>(n);
    auto next = row.begin();
    const auto put = [&](const Entry& entry) {
      // Several edges may join the same two nodes; their blocks add up.
      const bool again =
          static_cast<std::int32_t>(m.column.size()) > m.start[n] && m.column.back() == entry.node;
      if (!again) {
        m.column.push_back(entry.node);
        m.value.insert(m.value.end(), D * D, 0.0);
      }
      double* block = &m.value[m.value.size() - D * D];
      for (int col = 0; col < D; ++col) {
        Vec<D> unit{};
        unit[col] = 1.0;
        const Vec<D> y = stretch(entry, unit);
        for (int r = 0; r < D; ++r) block[r * D + col] -= y[r];
      }
    };
    for (; next != row.end() && (*next)->node < self; ++next) put(**next);
    m.column.push_back(self);
    m.value.insert(m.value.end(), &diagonal[n * D * D], &diagonal[n * D * D] + D * D);
    for (; next != row.end(); ++next) put(**next);
    m.start[n + 1] = static_cast<std::int32_t>(m.column.size());
  }
  matrix_ = std::move(m);
  matrix_generation_ = generation_;
  return matrix_;
}

template class Resistance<2>;
template class Resistance<3>;

}  // namespace odpd
