#include "odpd/geometry/pair_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "odpd/core/error.h"
#include "odpd/core/parallel.h"

namespace odpd {

template <int D>
CellList<D>::CellList(const Box<D>& box, double width, std::span<const Vec<D>> positions)
    : box_(box) {
  // More cells than a few per particle would only cost memory: wider ones serve a sparse box.
  const double most = 4.0 * static_cast<double>(positions.size()) + 1.0;
  Vec<D> count;
  double cells = 0.0;
  do {
    cells = 1.0;
    for (int c = 0; c < D; ++c) {
      count[c] = std::max(1.0, std::floor(box.size[c] / width));
      cells *= count[c];
    }
    width *= 1.25;
  } while (cells > most);
  for (int c = 0; c < D; ++c)
    count_[static_cast<std::size_t>(c)] = static_cast<std::int64_t>(count[c]);
  cell_count_ = static_cast<std::int64_t>(cells);
  start_.assign(static_cast<std::size_t>(cell_count_) + 1, 0);
  std::vector<std::int64_t> cell(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    cell[i] = cell_of(positions[i]);
    ++start_[static_cast<std::size_t>(cell[i]) + 1];
  }
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  member_.resize(positions.size());
  std::vector<std::int32_t> next(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < positions.size(); ++i)
    member_[static_cast<std::size_t>(next[static_cast<std::size_t>(cell[i])]++)] =
        static_cast<std::int32_t>(i);
}

template <int D>
std::int64_t CellList<D>::cell_of(const Vec<D>& r) const {
  std::int64_t cell = 0;
  for (int c = D - 1; c >= 0; --c) {
    const std::int64_t n = count_[static_cast<std::size_t>(c)];
    const double x = r[c] / box_.size[c] * static_cast<double>(n);
    // Outside a bounded direction (or not a number): the border cell.
    const std::int64_t k =
        x > 0.0 ? static_cast<std::int64_t>(std::min(x, static_cast<double>(n - 1))) : 0;
    cell = cell * n + k;
  }
  return cell;
}

template <int D>
std::span<const std::int32_t> CellList<D>::members(std::int64_t cell) const {
  const auto b = static_cast<std::size_t>(start_[static_cast<std::size_t>(cell)]);
  const auto e = static_cast<std::size_t>(start_[static_cast<std::size_t>(cell) + 1]);
  return std::span<const std::int32_t>(member_).subspan(b, e - b);
}

template <int D>
void CellList<D>::neighbourhood(std::int64_t cell, std::vector<std::int64_t>& out) const {
  out.assign(1, 0);
  std::int64_t stride = 1;
  for (int c = 0; c < D; ++c) {
    const std::int64_t n = count_[static_cast<std::size_t>(c)];
    const std::int64_t k = cell % n;
    cell /= n;
    std::array<std::int64_t, 3> line{k, k, k};
    std::size_t entries = 1;
    for (const std::int64_t step : {std::int64_t{-1}, std::int64_t{1}}) {
      std::int64_t other = k + step;
      if (box_.is_periodic(c)) {
        other = (other + n) % n;
      } else if (other < 0 || other >= n) {
        continue;
      }
      if (std::find(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(entries), other) ==
          line.begin() + static_cast<std::ptrdiff_t>(entries))
        line[entries++] = other;
    }
    const std::size_t before = out.size();
    for (std::size_t e = 1; e < entries; ++e)
      for (std::size_t b = 0; b < before; ++b) out.push_back(out[b] + line[e] * stride);
    for (std::size_t b = 0; b < before; ++b) out[b] += line[0] * stride;
    stride *= n;
  }
}

template <int D>
PairList<D>::PairList(const Box<D>& box, double cutoff, double skin)
    : box_(box), cutoff_(cutoff), skin_(skin) {
  for (int c = 0; c < D; ++c)
    if (box.is_periodic(c) && box.size[c] < 2.0 * cutoff)
      throw ConfigError(
          fmt::format("the box is {} long in direction {}, which is periodic: it must be at least "
                      "two cutoffs ({}), or a "
                      "particle would see a neighbour twice; enlarge box.size",
                      box.size[c], "xyz"[c], 2.0 * cutoff));
}

template <int D>
bool PairList<D>::valid_for(std::span<const Vec<D>> positions) const {
  if (reference_.size() != positions.size()) return false;
  const double limit = 0.25 * skin_ * skin_;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec<D> d = box_.separation(positions[i], reference_[i]);
    if (!(dot(d, d) <= limit)) return false;
  }
  return true;
}

template <int D>
bool PairList<D>::update(std::span<const Vec<D>> positions) {
  if (valid_for(positions)) return false;
  rebuild(positions);
  return true;
}

template <int D>
void PairList<D>::rebuild(std::span<const Vec<D>> positions) {
  const double reach = cutoff_ + skin_;
  const CellList<D> cells(box_, reach, positions);
  const auto n = static_cast<std::int64_t>(positions.size());
  constexpr std::int64_t chunk_length = 256;
  const std::int64_t chunks = (n + chunk_length - 1) / chunk_length;
  std::vector<std::vector<std::int32_t>> found(static_cast<std::size_t>(chunks));
  start_.assign(static_cast<std::size_t>(n) + 1, 0);
#pragma omp parallel for schedule(dynamic) if (threads() > 1)
  for (std::int64_t chunk = 0; chunk < chunks; ++chunk) {
    auto& mine = found[static_cast<std::size_t>(chunk)];
    std::vector<std::int64_t> around;
    for (std::int64_t i = chunk * chunk_length; i < std::min(n, (chunk + 1) * chunk_length); ++i) {
      const Vec<D>& ri = positions[static_cast<std::size_t>(i)];
      const std::size_t first = mine.size();
      cells.neighbourhood(cells.cell_of(ri), around);
      for (const std::int64_t cell : around)
        for (const std::int32_t j : cells.members(cell)) {
          if (j <= i) continue;
          const Vec<D> d = box_.separation(ri, positions[static_cast<std::size_t>(j)]);
          if (dot(d, d) < reach * reach) mine.push_back(j);
        }
      std::sort(mine.begin() + static_cast<std::ptrdiff_t>(first), mine.end());
      start_[static_cast<std::size_t>(i) + 1] = static_cast<std::int64_t>(mine.size() - first);
    }
  }
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  partner_.clear();
  partner_.reserve(static_cast<std::size_t>(start_.back()));
  for (const auto& part : found) partner_.insert(partner_.end(), part.begin(), part.end());
  reference_.assign(positions.begin(), positions.end());
  ++rebuilds_;
}

template <int D>
std::vector<std::int32_t> spatial_order(const Box<D>& box, double width,
                                        std::span<const Vec<D>> positions,
                                        std::span<const std::int64_t> id) {
  const CellList<D> cells(box, width, positions);
  std::vector<std::int32_t> order;
  order.reserve(positions.size());
  for (std::int64_t cell = 0; cell < cells.cells(); ++cell) {
    const auto members = cells.members(cell);
    const auto first = static_cast<std::ptrdiff_t>(order.size());
    order.insert(order.end(), members.begin(), members.end());
    std::sort(order.begin() + first, order.end(), [&](std::int32_t a, std::int32_t b) {
      return id[static_cast<std::size_t>(a)] < id[static_cast<std::size_t>(b)];
    });
  }
  return order;
}

template class CellList<2>;
template class CellList<3>;
template class PairList<2>;
template class PairList<3>;
template std::vector<std::int32_t> spatial_order<2>(const Box<2>&, double, std::span<const Vec<2>>,
                                                    std::span<const std::int64_t>);
template std::vector<std::int32_t> spatial_order<3>(const Box<3>&, double, std::span<const Vec<3>>,
                                                    std::span<const std::int64_t>);

}  // namespace odpd
