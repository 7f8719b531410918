#include "odpd/pairs/network.h"

#include <algorithm>
#include <numeric>

#include "odpd/pairs/edge_loop.h"

namespace odpd {

template <int D>
void PairNetwork<D>::resize(std::int64_t edges) {
  const auto n = static_cast<std::size_t>(edges);
  // Some room more: the number of edges changes by little from one configuration to the next.
  const auto resize_one = [&](auto& column) {
    if (column.capacity() < n) column.reserve(n + n / 32);
    column.resize(n);
  };
  resize_one(i);
  resize_one(j);
  resize_one(e);
  for (auto* column : {&r, &u, &f_c, &k_c, &zeta_par, &zeta_perp, &kT}) resize_one(*column);
  if (!slip_0.empty()) resize_one(slip_0);
  for (auto* constant :
       {&constant_k_c, &constant_zeta_perp, &constant_kT, &constant_f_c, &constant_u})
    constant->cut(n);
}

template <int D>
void PairNetwork<D>::ConstantColumn::fill(std::vector<double>& column, double value) {
  if (value_ != value) filled_ = 0;
  value_ = value;
  std::fill(column.begin() + static_cast<std::ptrdiff_t>(filled_), column.end(), value);
  filled_ = column.size();
}

template <int D>
void PairNetwork<D>::index_edges() {
  first.clear();
  start.assign(static_cast<std::size_t>(particles) + 1, 0);
  for (std::size_t k = 0; k < i.size(); ++k) {
    ++start[static_cast<std::size_t>(i[k]) + 1];
    ++start[static_cast<std::size_t>(j[k]) + 1];
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  edge.resize(2 * i.size());
  std::vector<std::int64_t> place(start.begin(), start.end() - 1);
  for (std::size_t k = 0; k < i.size(); ++k)
    for (const std::int32_t p : {i[k], j[k]})
      edge[static_cast<std::size_t>(place[static_cast<std::size_t>(p)]++)] =
          static_cast<std::int32_t>(k);
}

template <int D>
void PairNetwork<D>::index_rows() {
  const auto n = static_cast<std::size_t>(particles);
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
  if (edge.capacity() < 2 * i.size()) edge.reserve(2 * i.size() + i.size() / 16);
  edge.resize(2 * i.size());
  for_each_owned_edge(
      *this,
      [&](std::size_t p, std::size_t k) {
        edge[static_cast<std::size_t>(next[p]++)] = static_cast<std::int32_t>(k);
      },
      [&](std::size_t p, std::size_t begin, std::size_t) {
        std::iota(edge.begin() + next[p], edge.begin() + start[p + 1],
                  static_cast<std::int32_t>(begin));
      });
}

template <int D>
std::int64_t PairNetwork<D>::bytes() const {
  constexpr std::size_t per_edge = 2 * sizeof(std::int32_t) + sizeof(Vec<D>) + 7 * sizeof(double);
  return static_cast<std::int64_t>(i.size() * per_edge + slip_0.size() * sizeof(Vec<D>) +
                                   (edge.size() + scratch.size() + next.size()) *
                                       sizeof(std::int32_t) +
                                   (start.size() + first.size()) * sizeof(std::int64_t));
}

template struct PairNetwork<2>;
template struct PairNetwork<3>;

}  // namespace odpd
