#include "odpd/pairs/noise.h"

#include <algorithm>

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/core/random.h"
#include "odpd/core/room.h"

namespace odpd {

namespace {

// A vector changes sign with the order of i and j, as e does: the force is a function of the pair.
template <int D>
Vec<D> across_line(const Vec<D>& e, double sign, const std::array<double, 4>& w) {
  Vec<D> n;
  for (int c = 0; c < D; ++c) n[c] = sign * w[index(c)];
  return n - dot(n, e) * e;
}

// Pairs drawn at once.
constexpr std::size_t drawn_at_once = 256;

// Identities of the edges first, first + 1, ...
template <int D>
struct PairBlock {
  std::array<std::uint32_t, drawn_at_once> low, high;
  std::size_t first, size;

  PairBlock(const PairNetwork<D>& network, const Particles<D>& particles, std::int64_t begin,
            std::int64_t end)
      : first(index(begin)), size(index(end - begin)) {
    for (std::size_t k = 0; k < size; ++k) {
      const auto a = static_cast<std::uint32_t>(particles.id[index(network.i[first + k])]);
      const auto b = static_cast<std::uint32_t>(particles.id[index(network.j[first + k])]);
      low[k] = std::min(a, b);
      high[k] = std::max(a, b);
    }
  }
  std::span<const std::uint32_t> lows() const { return {low.data(), size}; }
  std::span<const std::uint32_t> highs() const { return {high.data(), size}; }
};

template <int D>
void add_across(const PairRandom& random, const PairBlock<D>& pairs, const PairNetwork<D>& network,
                const Particles<D>& particles, double dt, std::vector<Vec<D>>& force) {
  std::array<std::array<double, drawn_at_once>, 4> w;
  random.four(pairs.lows(), pairs.highs(), {w[0], w[1], w[2], w[3]});
  for (std::size_t n = 0; n < pairs.size; ++n) {
    const std::size_t k = pairs.first + n;
    const bool ascending = particles.id[index(network.i[k])] == pairs.low[n];
    force[k] +=
        std::sqrt(2.0 * network.kT[k] / dt * network.zeta_perp[k]) *
        across_line<D>(network.e[k], ascending ? 1.0 : -1.0, {w[0][n], w[1][n], w[2][n], w[3][n]});
  }
}

}  // namespace

template <int D>
EdgeNormals<D>::EdgeNormals(const PairRandom& random, const PairNetwork<D>& network,
                            const Particles<D>& particles, std::size_t k)
    : random_(random), e_(network.e[k]) {
  const PairBlock<D> pair(network, particles, static_cast<std::int64_t>(k),
                          static_cast<std::int64_t>(k) + 1);
  low_ = pair.low[0];
  high_ = pair.high[0];
  sign_ = particles.id[index(network.i[k])] == low_ ? 1.0 : -1.0;
}

template <int D>
double EdgeNormals<D>::along() const {
  double w = 0.0;
  random_.one({&low_, 1}, {&high_, 1}, {&w, 1});
  return w;
}

template <int D>
Vec<D> EdgeNormals<D>::across() const {
  std::array<double, 4> w;
  random_.four(
      {&low_, 1}, {&high_, 1},
      {std::span(&w[0], 1), std::span(&w[1], 1), std::span(&w[2], 1), std::span(&w[3], 1)});
  return across_line<D>(e_, sign_, w);
}

template <int D>
void draw_edge_noise(const PairNetwork<D>& network, const Particles<D>& particles,
                     std::uint64_t seed, std::uint64_t step, double dt,
                     std::vector<Vec<D>>& force) {
  const PairRandom random(seed, step);
  resize_afresh(force, index(network.size()));
  parallel_ranges(network.size(), drawn_at_once, [&](std::int64_t begin, std::int64_t end) {
    const PairBlock<D> pairs(network, particles, begin, end);
    std::array<double, drawn_at_once> w;
    random.one(pairs.lows(), pairs.highs(), w);
    for (std::size_t n = 0; n < pairs.size; ++n) {
      const std::size_t k = pairs.first + n;
      force[k] = std::sqrt(2.0 * network.kT[k] / dt * network.zeta_par[k]) * w[n] * network.e[k];
    }
    if (network.transverse) add_across(random, pairs, network, particles, dt, force);
  });
}

template <int D>
void add_drag_noise(const Particles<D>& particles, std::uint64_t seed, std::uint64_t step,
                    double amplitude, std::vector<Vec<D>>& force) {
  const CounterRandom random(seed, Stream::drag_noise);
  parallel_for(particles.size(), [&](std::int64_t particle) {
    const auto i = index(particle);
    if (particles.is_known(i)) return;
    const auto n = random.normals(step, 0, static_cast<std::uint64_t>(particles.id[i]), 0);
    for (std::size_t c = 0; c < D; ++c) force[i].x[c] += amplitude * n[c];
  });
}

template class EdgeNormals<2>;
template class EdgeNormals<3>;
template void add_drag_noise<2>(const Particles<2>&, std::uint64_t, std::uint64_t, double,
                                std::vector<Vec<2>>&);
template void add_drag_noise<3>(const Particles<3>&, std::uint64_t, std::uint64_t, double,
                                std::vector<Vec<3>>&);
template void draw_edge_noise<2>(const PairNetwork<2>&, const Particles<2>&, std::uint64_t,
                                 std::uint64_t, double, std::vector<Vec<2>>&);
template void draw_edge_noise<3>(const PairNetwork<3>&, const Particles<3>&, std::uint64_t,
                                 std::uint64_t, double, std::vector<Vec<3>>&);

}  // namespace odpd
