#include "odpd/operator/resistance.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/core/room.h"
#include "odpd/pairs/friction.h"

namespace odpd {

namespace {

template <int D>
Vec<D> load(std::span<const double> x, std::size_t node) {
  Vec<D> v;
  for (int c = 0; c < D; ++c) v[c] = x[node * D + index(c)];
  return v;
}

template <int D>
std::size_t other_end(const PairNetwork<D>& network, std::int32_t edge, std::int32_t particle) {
  const auto k = index(edge);
  return index(network.i[k] == particle ? network.j[k] : network.i[k]);
}

void refuse_many_free_motions(const FreeMotions& free, std::span<const std::int64_t> id) {
  if (free.motions <= most_free_motions) return;
  throw SolverError(
      fmt::format("{} groups of particles, one with particle {}, can each move as one along what "
                  "holds them, or turn about it: friction along lines of centres does not resist "
                  "these {} null motions of R, and at most {} can be kept out of v. Cures: {}, "
                  "mass (fluid.mass) or {}",
                  free.groups.size(), id[index(free.groups.front().first)], free.motions,
                  most_free_motions, drag_cure, transverse_cure),
      SolverError::Cause::singular);
}

}  // namespace

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
void Resistance<D>::rebuild(const PairNetwork<D>& network, const DofMap<D>& dofs,
                            const Particles<D>& particles, std::span<const Vec<D>> positions,
                            double shift, double stiffness_time, double bond_time,
                            std::span<const Vec<D>> arms) {
  nodes_ = dofs.mobile();
  share_ = dofs.mobile_share();
  shift_ = shift;
  stiffness_time_ = stiffness_time;
  bond_time_ = bond_time;
  ++generation_;
  const auto n_nodes = index(nodes_);
  weigh_edges(network);
  count_links(network, dofs);
  resize_afresh(links_, index(start_.back()));
  const bool anchored = shift != 0.0 || share_.ranks->any(dofs.mobile() < dofs.particles());
  anchor_.assign(anchored ? n_nodes : 0, Block{});
  diagonal_.resize(n_nodes);
  parent_.resize(n_nodes);
  positions_.resize(n_nodes * D);
  parallel_for(nodes_, [&](std::int64_t node) {
    const auto n = index(node);
    const std::int32_t particle = dofs.particle_of(n);
    for (std::size_t c = 0; c < D; ++c) positions_[n * D + c] = positions[index(particle)].x[c];
    fill_row(n, particle, network, dofs);
  });
  const auto own_anchors = share_.part(std::span(anchor_), 1);
  translations_are_null_ =
      share_.ranks->all(std::all_of(own_anchors.begin(), own_anchors.end(), [](const Block& block) {
        return std::all_of(block.begin(), block.end(), [](double entry) { return entry == 0.0; });
      }));
  if (translations_are_null_) anchor_.clear();
  free_ = {};
  if (shift != 0.0) return;
  share_.ranks->together([&] { check_rattlers(network, dofs, particles); });
  share_.ranks->together([&] { check_clusters(dofs, particles); });
  // With the centre of mass held the problem is another one.
  if (holds_centre_of_mass()) return;
  free_ = free_motions<D>(*this, dofs, arms, parent_);
  share_.ranks->together([&] { refuse_many_free_motions(free_, particles.id); });
}

template <int D>
void Resistance<D>::weigh_edges(const PairNetwork<D>& network) {
  const bool transverse = network.transverse;
  const std::int64_t pairs = network.pairs();
  // Edges before it take no part of their stiffness.
  const std::int64_t stiff_from = stiffness_time_ != 0.0 ? 0 : pairs;
  const auto edges = index(network.size());
  resize_afresh(g_, edges);
  resize_afresh(across_, transverse ? edges : 0);
  sees_spins_.resize(network.lever_i.size());
  parallel_for(std::ssize(sees_spins_), [&](std::int64_t edge) {
    const auto k = index(edge);
    sees_spins_[k] = network.lever_i[k] + network.lever_j[k] > 0.0 ? 1 : 0;
  });
  parallel_for(network.size(), [&](std::int64_t edge) {
    const auto k = index(edge);
    double along = network.zeta_par[k];
    if (edge >= stiff_from)
      along += (edge < pairs ? stiffness_time_ : bond_time_) * std::max(network.k_c[k], 0.0);
    if (transverse) {
      along -= network.zeta_perp[k];
      across_[k] = {network.zeta_perp[k], along < 0.0 ? -1.0 : 1.0};
    }
    g_[k] = std::sqrt(std::abs(along)) * network.e[k];
  });
}

template <int D>
void Resistance<D>::count_links(const PairNetwork<D>& network, const DofMap<D>& dofs) {
  if (dofs.mobile() == dofs.particles()) {
    start_.assign(network.start.begin(), network.start.end());
    return;
  }
  start_.assign(index(nodes_) + 1, 0);
  parallel_for(nodes_, [&](std::int64_t node) {
    const auto n = index(node);
    const std::int32_t particle = dofs.particle_of(n);
    for (const std::int32_t edge : network.edges_of(particle))
      if (dofs.mobile_of(other_end(network, edge, particle)) >= 0) ++start_[n + 1];
  });
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
}

template <int D>
void Resistance<D>::fill_row(std::size_t node, std::int32_t particle, const PairNetwork<D>& network,
                             const DofMap<D>& dofs) {
  Block free{}, known{};  // upper triangles
  Link* link = links_.data() + start_[node];
  auto parent = static_cast<std::int32_t>(node);
  for (const std::int32_t edge : network.edges_of(particle)) {
    const auto k = index(edge);
    const std::int32_t partner = dofs.mobile_of(other_end(network, edge, particle));
    Block& sum = partner >= 0 ? free : known;
    Vec<D> g = g_[k];
    if (!across_.empty()) {
      for (std::size_t c = 0; c < D; ++c) sum[c * D + c] += across_[k].zeta_perp;
      for (std::size_t row = 0; row < D; ++row)
        for (std::size_t col = row; col < D; ++col)
          sum[row * D + col] += across_[k].sign * g.x[row] * g.x[col];
    } else {
      for (std::size_t row = 0; row < D; ++row)
        for (std::size_t col = row; col < D; ++col) sum[row * D + col] += g.x[row] * g.x[col];
    }
    if (partner < 0) continue;
    *link = {edge, partner};
    if (partner < parent && ties(*link)) parent = partner;
    ++link;
  }
  parent_[index(node)] = parent;
  for (std::size_t c = 0; c < D; ++c) known[c * D + c] += shift_;
  Block& diagonal = diagonal_[node];
  for (std::size_t row = 0; row < D; ++row)
    for (std::size_t col = row; col < D; ++col) {
      known[col * D + row] = known[row * D + col];
      diagonal[row * D + col] = diagonal[col * D + row] =
          free[row * D + col] + known[row * D + col];
    }
  if (!anchor_.empty()) anchor_[node] = known;
}

template <int D>
void Resistance<D>::check_rattlers(const PairNetwork<D>& network, const DofMap<D>& dofs,
                                   const Particles<D>& particles) const {
  // Below this a block inverse would amplify rounding beyond any tolerance in use.
  constexpr double singular = 1e-12;
  std::atomic<std::int64_t> first{nodes_};
  parallel_for(share_.end(nodes_) - share_.first, [&](std::int64_t own) {
    const std::int64_t node = share_.first + own;
    const auto n = index(node);
    if (relative_determinant<D>(diagonal_[n].data()) > singular) return;
    if (!particles.is_free(index(dofs.particle_of(n)))) return;  // held by its body
    lower(first, node);
  });
  if (first < nodes_) {
    const auto n = index(first.load());
    const std::int32_t particle = dofs.particle_of(n);
    throw SolverError(
        fmt::format(
            "particle {} is a rattler: its {} neighbour(s) within the cutoff leave it free to move "
            "in some direction without friction, so R is singular. Cures: a higher density, a "
            "larger "
            "cutoff (of \"sdpd\" fluid.support), or, where friction is DPD's, a weak pairwise one "
            "of "
            "longer range (fluid.rattler_friction = {{ gamma = 0.1, cutoff = 2.0 }})",
            particles.id[index(particle)], network.edges_of(particle).size()),
        SolverError::Cause::singular);
  }
}

// Nodes joined by links move as one; each such group must be held by particles of known velocity, or be the only one.
// A node's parent is its lowest neighbour (fill_row), so that the roots of this forest are the few nodes without a lower
// one, and the links of those nearly always join it.
template <int D>
void Resistance<D>::check_clusters(const DofMap<D>& dofs, const Particles<D>& particles) {
  const auto n_nodes = index(nodes_);
  std::vector<std::int32_t>& parent = parent_;
  std::vector<std::size_t> roots;
  for (std::size_t n = 0; n < n_nodes; ++n) {
    auto& up = parent[n];
    if (up == static_cast<std::int32_t>(n)) roots.push_back(n);
    up = parent[index(up)];  // lower nodes point to their roots already
  }
  std::size_t groups = roots.size();
  const auto root = [&](std::int32_t n) {
    while (parent[index(n)] != n) {
      auto& up = parent[index(n)];
      up = parent[index(up)];
      n = up;
    }
    return n;
  };
  const auto unite = [&](std::int32_t m, std::int32_t n) {
    const std::int32_t a = root(m), b = root(n);
    if (a == b) return;
    parent[index(std::max(a, b))] = std::min(a, b);
    --groups;
  };
  const auto join = [&](std::size_t n) {
    for (const Link& link : links(n))
      if (ties(link)) unite(static_cast<std::int32_t>(n), link.node);
  };
  for (std::size_t b = 0; b < index(dofs.bodies()); ++b)
    for (const std::int32_t particle : dofs.constituents(b))
      unite(dofs.mobile_of(index(dofs.constituents(b)[0])), dofs.mobile_of(index(particle)));
  for (const std::size_t n : roots) join(n);
  if (groups <= 1) return;  // held, or the null space
  for (std::size_t n = 0; n < n_nodes && groups > 1; ++n) join(n);
  std::vector<bool> held(n_nodes, false);
  for (std::size_t n = 0; n < anchor_.size(); ++n)
    if (anchor_[n] != Block{}) held[index(root(static_cast<std::int32_t>(n)))] = true;
  // Without any known velocity the first group carries the null space, and there may be no second.
  if (translations_are_null_ && n_nodes > 0) held[index(root(0))] = true;
  for (std::size_t n = 0; n < n_nodes; ++n) {
    const std::int32_t own = root(static_cast<std::int32_t>(n));
    if (held[index(own)]) continue;
    std::int64_t members = 0;
    for (std::size_t m = n; m < n_nodes; ++m)
      if (root(static_cast<std::int32_t>(m)) == own) ++members;
    throw SolverError(
        fmt::format(
            "{} particle(s), among them particle {}, are a group of particles out of reach "
            "of all others, which can move freely as one, so R is singular. Cures: {}, "
            "mass (fluid.mass), a higher density, a larger cutoff (of \"sdpd\" "
            "fluid.support), or, where friction is DPD's, a weak pairwise one of longer range "
            "that reaches the others (fluid.rattler_friction = {{ gamma = 0.1, cutoff = 2.0 "
            "}})",
            members, particles.id[index(dofs.particle_of(n))], drag_cure),
        SolverError::Cause::singular);
  }
}

/// Friction force of a link per slip: (+- g g^T + zeta_perp I) slip.
template <int D>
Vec<D> Resistance<D>::pull(const Link& link, const Vec<D>& slip) const {
  const Vec<D>& direction = g(link);
  if (across_.empty()) return dot(direction, slip) * direction;
  const Across& a = across(link);
  return a.sign * dot(direction, slip) * direction + a.zeta_perp * slip;
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
  for (const Link& link : links(node)) {
    const Vec<D> slip = own - load<D>(x, index(link.node));
    if constexpr (transverse) {
      sum += pull(link, slip);
    } else {
      sum += dot(g(link), slip) * g(link);
    }
  }
  return sum;
}

template <int D>
void Resistance<D>::apply(std::span<const double> x, std::span<double> y) const {
  const bool transverse = !across_.empty();
  parallel_for(nodes_, [&](std::int64_t node) {
    const auto n = index(node);
    const Vec<D> sum = transverse ? row_product<true>(n, x) : row_product<false>(n, x);
    for (std::size_t c = 0; c < D; ++c) y[n * D + c] = sum.x[c];
  });
}

template <int D>
void Resistance<D>::block_diagonal(std::span<double> blocks) const {
  parallel_for(nodes_, [&](std::int64_t node) {
    const auto n = index(node);
    std::copy(diagonal_[n].begin(), diagonal_[n].end(), &blocks[n * D * D]);
  });
}

template <int D>
const BlockCsr& Resistance<D>::matrix() const {
  if (matrix_generation_ == generation_) return matrix_;
  BlockCsr m;
  m.block = D;
  m.rows = static_cast<std::int32_t>(nodes_);
  m.start.assign(index(nodes_) + 1, 0);
  std::vector<Link> row;
  for (std::size_t n = 0; n < index(nodes_); ++n) {
    row.assign(links(n).begin(), links(n).end());
    std::stable_sort(row.begin(), row.end(),
                     [](const Link& a, const Link& b) { return a.node < b.node; });
    const auto self = static_cast<std::int32_t>(n);
    auto next = row.begin();
    const auto put = [&](const Link& link) {
      // Several edges may join the same two nodes; their blocks add up.
      if (static_cast<std::int32_t>(m.column.size()) == m.start[n] ||
          m.column.back() != link.node) {
        m.column.push_back(link.node);
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
    for (; next != row.end() && next->node < self; ++next) put(*next);
    m.column.push_back(self);
    m.value.insert(m.value.end(), diagonal_[n].begin(), diagonal_[n].end());
    for (; next != row.end(); ++next) put(*next);
    m.start[n + 1] = static_cast<std::int32_t>(m.column.size());
  }
  matrix_ = std::move(m);
  matrix_generation_ = generation_;
  return matrix_;
}

template double relative_determinant<2>(const double*);
template double relative_determinant<3>(const double*);
template double relative_determinant<4>(const double*);
template double relative_determinant<6>(const double*);
template class Resistance<2>;
template class Resistance<3>;

}  // namespace odpd
