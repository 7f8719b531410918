#include "odpd/pairs/network.h"

#include <algorithm>
#include <numeric>

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/core/room.h"
#include "odpd/pairs/edge_loop.h"

namespace odpd {

namespace {

// Some room more: the number of edges changes by little from one configuration to the next.
void resize_with_room(auto& column, std::size_t n) {
  if (column.capacity() < n) column.reserve(n + n / 32);
  column.resize(n);
}

}  // namespace

void DensityColumns::resize(std::size_t particles, std::size_t pairs) {
  for (auto* column : {&d, &psi, &psi_1, &psi_2}) column->resize(particles);
  for (auto* column : {&W, &W_1}) resize_with_room(*column, pairs);
}

std::int64_t DensityColumns::bytes() const {
  return static_cast<std::int64_t>((4 * d.size() + 2 * W.size()) * sizeof(double));
}

template <int D>
double PairNetwork<D>::energy() const {
  if (owned.alone()) return densities.empty() ? u.sum() : u.sum() + fixed_sum(densities.psi);
  double sum = 0.0;
  for (std::size_t k = 0; k < i.size(); ++k) sum += counts(k) ? u[k] : 0.0;
  for (auto p = index(owned.first); p < index(owned.end(std::ssize(densities.psi))); ++p)
    sum += densities.psi[p];
  return owned.ranks->sum(sum);
}

template <int D>
void PairNetwork<D>::resize(std::int64_t edges) {
  const auto n = index(edges);
  bonds = 0;
  beyond.clear();
  resize_with_room(i, n);
  resize_with_room(j, n);
  resize_with_room(e, n);
  resize_with_room(r, n);
  resize_with_room(f_c, n);
  resize_with_room(zeta_par, n);
  for (Column* column : {&u, &k_c, &zeta_perp, &kT}) column->resize(n);
  if (!densities.empty()) densities.resize(densities.d.size(), n);
}

template <int D>
void PairNetwork<D>::index_edges() {
  first.clear();
  start.assign(index(particles) + 1, 0);
  for (std::size_t k = 0; k < i.size(); ++k) {
    ++start[index(i[k]) + 1];
    ++start[index(j[k]) + 1];
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  edge.resize(2 * i.size());
  std::vector<std::int64_t> place(start.begin(), start.end() - 1);
  for (std::size_t k = 0; k < i.size(); ++k)
    for (const std::int32_t p : {i[k], j[k]})
      edge[index(place[index(p)]++)] = static_cast<std::int32_t>(k);
}

template <int D>
void PairNetwork<D>::index_rows() {
  const auto n = index(particles);
  next.assign(n, 0);
  for_each_owned_edge(
      *this, [&](std::size_t p, std::size_t) { ++next[p]; },
      [](std::size_t, std::size_t, std::size_t) {});
  start.resize(n + 1);
  start[0] = 0;
  for (std::size_t p = 0; p < n; ++p) {
    start[p + 1] = start[p] + next[p] + (first[p + 1] - first[p]);
    next[p] = static_cast<std::int32_t>(start[p]);
  }
  resize_afresh(edge, 2 * i.size());
  for_each_owned_edge(
      *this,
      [&](std::size_t p, std::size_t k) { edge[index(next[p]++)] = static_cast<std::int32_t>(k); },
      [&](std::size_t p, std::size_t begin, std::size_t) {
        std::iota(edge.begin() + next[p], edge.begin() + start[p + 1],
                  static_cast<std::int32_t>(begin));
      });
}

template <int D>
void PairNetwork<D>::index_bonds(std::int64_t count) {
  bonds = count;
  const auto n = index(particles);
  next.assign(n, 0);
  for (auto k = index(pairs()); k < i.size(); ++k)
    for (const std::int32_t p : {i[k], j[k]}) ++next[index(p)];
  edge.resize(2 * i.size());
  // From the end on, each particle's edges move up by the bonds of those before it.
  std::int64_t shift = 2 * count;
  for (std::size_t p = n; p-- > 0 && shift > 0;) {
    const std::int64_t begin = start[p], end = start[p + 1];
    start[p + 1] += shift;
    shift -= next[p];
    if (shift > 0)
      std::copy_backward(edge.begin() + begin, edge.begin() + end, edge.begin() + end + shift);
    next[p] = static_cast<std::int32_t>(end + shift);
  }
  for (auto k = index(pairs()); k < i.size(); ++k)
    for (const std::int32_t p : {i[k], j[k]})
      edge[index(next[index(p)]++)] = static_cast<std::int32_t>(k);
}

template <int D>
std::int64_t PairNetwork<D>::bytes() const {
  constexpr std::size_t per_edge = 2 * sizeof(std::int32_t) + sizeof(Vec<D>) + 3 * sizeof(double);
  std::int64_t columns = densities.bytes();
  for (const Column* column : {&u, &k_c, &zeta_perp, &kT}) columns += column->bytes();
  return columns + static_cast<std::int64_t>(
                       i.size() * per_edge + slip_0.size() * sizeof(Vec<D>) +
                       2 * lever_i.size() * sizeof(double) + beyond.size() * sizeof(Beyond) +
                       (edge.size() + scratch.size() + next.size()) * sizeof(std::int32_t) +
                       (start.size() + first.size()) * sizeof(std::int64_t));
}

template struct PairNetwork<2>;
template struct PairNetwork<3>;

}  // namespace odpd
