#include "odpd/pairs/network.h"

#include <numeric>

namespace odpd {

template <int D>
void PairNetwork<D>::resize(std::int64_t edges) {
  const auto n = static_cast<std::size_t>(edges);
  i.resize(n);
  j.resize(n);
  e.resize(n);
  for (auto* column : {&r, &u, &f_c, &k_c, &zeta_par, &zeta_perp, &kT}) column->resize(n);
}

template <int D>
void PairNetwork<D>::index_edges() {
  start.assign(static_cast<std::size_t>(particles) + 1, 0);
  for (std::size_t k = 0; k < i.size(); ++k) {
    ++start[static_cast<std::size_t>(i[k]) + 1];
    ++start[static_cast<std::size_t>(j[k]) + 1];
  }
  std::partial_sum(start.begin(), start.end(), start.begin());
  edge.resize(2 * i.size());
  std::vector<std::int64_t> next(start.begin(), start.end() - 1);
  for (std::size_t k = 0; k < i.size(); ++k)
    for (const std::int32_t p : {i[k], j[k]})
      edge[static_cast<std::size_t>(next[static_cast<std::size_t>(p)]++)] =
          static_cast<std::int32_t>(k);
}

template <int D>
std::int64_t PairNetwork<D>::bytes() const {
  constexpr std::size_t per_edge = 2 * sizeof(std::int32_t) + sizeof(Vec<D>) + 7 * sizeof(double);
  return static_cast<std::int64_t>(i.size() * per_edge + edge.size() * sizeof(std::int32_t) +
                                   start.size() * sizeof(std::int64_t));
}

template struct PairNetwork<2>;
template struct PairNetwork<3>;

}  // namespace odpd
