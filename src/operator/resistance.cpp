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

template <int D>
std::size_t other_end(const PairNetwork<D>& network, std::int32_t edge, std::int32_t particle) {
  const auto k = static_cast<std::size_t>(edge);
  return static_cast<std::size_t>(network.i[k] == particle ? network.j[k] : network.i[k]);
}

}  // namespace

template <int D>
void Resistance<D>::rebuild(const PairNetwork<D>& network, const DofMap<D>& dofs,
                            const Particles<D>& particles, std::span<const Vec<D>> positions,
                            double shift, double stiffness_time) {
  nodes_ = dofs.nodes();
  shift_ = shift;
  stiffness_time_ = stiffness_time;
  ++generation_;
  const auto n_nodes = static_cast<std::size_t>(nodes_);
  start_.assign(n_nodes + 1, 0);
  parallel_for(nodes_, [&](std::int64_t node) {
    const auto n = static_cast<std::size_t>(node);
    const std::int32_t particle = dofs.particle_of(n);
    for (const std::int32_t edge : network.edges_of(particle))
      if (dofs.node_of(other_end(network, edge, particle)) >= 0) ++start_[n + 1];
  });
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  links_.resize(static_cast<std::size_t>(start_.back()));
  across_.resize(network.transverse ? links_.size() : 0);
  anchor_.assign(n_nodes, Block{});
  positions_.resize(n_nodes * D);
  parallel_for(nodes_, [&](std::int64_t node) {
    const auto n = static_cast<std::size_t>(node);
    const std::int32_t particle = dofs.particle_of(n);
    for (std::size_t c = 0; c < D; ++c)
      positions_[n * D + c] = positions[static_cast<std::size_t>(particle)].x[c];
    fill_row(n, particle, network, dofs);
  });
  const bool anchored = std::any_of(anchor_.begin(), anchor_.end(), [](const Block& block) {
    return std::any_of(block.begin(), block.end(), [](double entry) { return entry != 0.0; });
  });
  translations_are_null_ = !anchored;
  if (!anchored) anchor_.clear();
  if (shift != 0.0) return;
  check_rattlers(network, dofs, particles);
  check_clusters(dofs, particles);
}

template <int D>
void Resistance<D>::fill_row(std::size_t node, std::int32_t particle, const PairNetwork<D>& network,
                             const DofMap<D>& dofs) {
  Block& anchor = anchor_[node];
  for (std::size_t c = 0; c < D; ++c) anchor[c * D + c] = shift_;
  auto slot = static_cast<std::size_t>(start_[node]);
  for (const std::int32_t edge : network.edges_of(particle)) {
    const auto k = static_cast<std::size_t>(edge);
    const double along = network.zeta_par[k] + stiffness_time_ * std::max(network.k_c[k], 0.0) -
                         network.zeta_perp[k];
    const std::int32_t partner = dofs.node_of(other_end(network, edge, particle));
    if (partner >= 0) {
      links_[slot] = {std::sqrt(std::abs(along)) * network.e[k], partner};
      if (network.transverse) across_[slot] = {network.zeta_perp[k], along < 0.0 ? -1.0 : 1.0};
      ++slot;
      continue;
    }
    for (std::size_t row = 0; row < D; ++row)
      for (std::size_t col = 0; col < D; ++col)
        anchor[row * D + col] += along * network.e[k].x[row] * network.e[k].x[col] +
                                 (row == col ? network.zeta_perp[k] : 0.0);
  }
}

template <int D>
void Resistance<D>::check_rattlers(const PairNetwork<D>& network, const DofMap<D>& dofs,
                                   const Particles<D>& particles) const {
  std::vector<double> blocks(static_cast<std::size_t>(nodes_) * D * D);
  block_diagonal(blocks);
  // Below this a block inverse would amplify rounding beyond any tolerance in use.
  constexpr double singular = 1e-12;
  for (std::size_t n = 0; n < static_cast<std::size_t>(nodes_); ++n) {
    if (relative_determinant<D>(&blocks[n * D * D]) > singular) continue;
    const std::int32_t particle = dofs.particle_of(n);
    throw SolverError(fmt::format(
        "particle {} is a rattler: its {} neighbour(s) within the cutoff leave it free to move in "
        "some direction "
        "without friction, so R is singular. Cures: a weak pairwise friction of longer range "
        "(fluid.rattler_friction = {{ gamma = 0.1, cutoff = 2.0 }}), a higher density, or a larger "
        "cutoff",
        particles.id[static_cast<std::size_t>(particle)], network.edges_of(particle).size()));
  }
}

// Nodes joined by links move as one; each such group must be held by particles of known velocity, or be the only one.
template <int D>
void Resistance<D>::check_clusters(const DofMap<D>& dofs, const Particles<D>& particles) const {
  const auto n_nodes = static_cast<std::size_t>(nodes_);
  std::vector<std::int32_t> parent(n_nodes);
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t n) {
    while (parent[static_cast<std::size_t>(n)] != n) {
      auto& up = parent[static_cast<std::size_t>(n)];
      up = parent[static_cast<std::size_t>(up)];
      n = up;
    }
    return n;
  };
  for (std::size_t n = 0; n < n_nodes; ++n)
    for (auto k = static_cast<std::size_t>(start_[n]); k < static_cast<std::size_t>(start_[n + 1]);
         ++k)
      if (dot(links_[k].g, links_[k].g) > 0.0 || !across_.empty())
        parent[static_cast<std::size_t>(root(links_[k].node))] = root(static_cast<std::int32_t>(n));
  std::vector<bool> held(n_nodes, false);
  for (std::size_t n = 0; n < anchor_.size(); ++n)
    if (anchor_[n] != Block{})
      held[static_cast<std::size_t>(root(static_cast<std::int32_t>(n)))] = true;
  // Without any known velocity the first group carries the null space, and there may be no second.
  if (translations_are_null_ && n_nodes > 0) held[static_cast<std::size_t>(root(0))] = true;
  for (std::size_t n = 0; n < n_nodes; ++n) {
    if (held[static_cast<std::size_t>(root(static_cast<std::int32_t>(n)))]) continue;
    throw SolverError(
        fmt::format("particle {} belongs to a group of particles out of reach of all others, which "
                    "can move freely as one, so R is "
                    "singular. Cures: a weak pairwise friction of longer range "
                    "(fluid.rattler_friction = {{ gamma = 0.1, cutoff = "
                    "2.0 }}), a higher density, or a larger cutoff",
                    particles.id[static_cast<std::size_t>(dofs.particle_of(n))]));
  }
}

/// Friction force of a link per slip: (+- g g^T + zeta_perp I) slip.
template <int D>
Vec<D> Resistance<D>::pull(std::size_t link, const Vec<D>& slip) const {
  const Vec<D>& g = links_[link].g;
  if (across_.empty()) return dot(g, slip) * g;
  const Across& a = across_[link];
  return a.sign * dot(g, slip) * g + a.zeta_perp * slip;
}

template <int D>
template <bool transverse>
Vec<D> Resistance<D>::row_product(std::size_t node, std::span<const double> x) const {
  const Vec<D> own = load<D>(x, node);
  Vec<D> sum;
  if (!anchor_.empty())
    for (std::size_t row = 0; row < D; ++row)
      for (std::size_t col = 0; col < D; ++col)
        sum.x[row] += anchor_[node][row * D + col] * own.x[col];
  const auto end = static_cast<std::size_t>(start_[node + 1]);
  for (auto k = static_cast<std::size_t>(start_[node]); k < end; ++k) {
    const Vec<D> slip = own - load<D>(x, static_cast<std::size_t>(links_[k].node));
    if constexpr (transverse) {
      sum += pull(k, slip);
    } else {
      sum += dot(links_[k].g, slip) * links_[k].g;
    }
  }
  return sum;
}

template <int D>
void Resistance<D>::apply(std::span<const double> x, std::span<double> y) const {
  const bool transverse = !across_.empty();
  parallel_for(nodes_, [&](std::int64_t node) {
    const auto n = static_cast<std::size_t>(node);
    const Vec<D> sum = transverse ? row_product<true>(n, x) : row_product<false>(n, x);
    for (std::size_t c = 0; c < D; ++c) y[n * D + c] = sum.x[c];
  });
}

template <int D>
void Resistance<D>::block_diagonal(std::span<double> blocks) const {
  parallel_for(nodes_, [&](std::int64_t node) {
    const auto n = static_cast<std::size_t>(node);
    for (std::size_t col = 0; col < D; ++col) {
      Vec<D> unit{};
      unit.x[col] = 1.0;
      Vec<D> sum;
      for (std::size_t row = 0; row < D && !anchor_.empty(); ++row)
        sum.x[row] = anchor_[n][row * D + col];
      const auto end = static_cast<std::size_t>(start_[n + 1]);
      for (auto k = static_cast<std::size_t>(start_[n]); k < end; ++k) sum += pull(k, unit);
      for (std::size_t row = 0; row < D; ++row) blocks[(n * D + row) * D + col] = sum.x[row];
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
  std::vector<std::size_t> row;
  for (std::size_t n = 0; n < static_cast<std::size_t>(nodes_); ++n) {
    row.resize(static_cast<std::size_t>(start_[n + 1] - start_[n]));
    std::iota(row.begin(), row.end(), static_cast<std::size_t>(start_[n]));
    std::stable_sort(row.begin(), row.end(),
                     [&](std::size_t a, std::size_t b) { return links_[a].node < links_[b].node; });
    const auto self = static_cast<std::int32_t>(n);
    auto next = row.begin();
    const auto put = [&](std::size_t link) {
      // Several edges may join the same two nodes; their blocks add up.
      const std::int32_t column = links_[link].node;
      if (static_cast<std::int32_t>(m.column.size()) == m.start[n] || m.column.back() != column) {
        m.column.push_back(column);
        m.value.insert(m.value.end(), D * D, 0.0);
      }
      double* block = &m.value[m.value.size() - D * D];
      for (std::size_t col = 0; col < D; ++col) {
        Vec<D> unit{};
        unit.x[col] = 1.0;
        const Vec<D> y = pull(link, unit);
        for (std::size_t r = 0; r < D; ++r) block[r * D + col] -= y.x[r];
      }
    };
    for (; next != row.end() && links_[*next].node < self; ++next) put(*next);
    m.column.push_back(self);
    m.value.insert(m.value.end(), &diagonal[n * D * D], &diagonal[n * D * D] + D * D);
    for (; next != row.end(); ++next) put(*next);
    m.start[n + 1] = static_cast<std::int32_t>(m.column.size());
  }
  matrix_ = std::move(m);
  matrix_generation_ = generation_;
  return matrix_;
}

template class Resistance<2>;
template class Resistance<3>;

}  // namespace odpd
