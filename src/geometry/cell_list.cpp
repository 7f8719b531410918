#include <algorithm>
#include <cmath>

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/geometry/pair_list.h"

namespace odpd {

template <int D>
CellList<D>::CellList(const Box<D>& box, double width, std::span<const Vec<D>> positions)
    : box_(box) {
  assign(width, positions);
}

template <int D>
void CellList<D>::choose_cells(double width, std::size_t particles) {
  // More cells than a few per particle would only cost memory: wider ones serve a sparse box.
  const double most = 4.0 * static_cast<double>(particles) + 1.0;
  Vec<D> count;
  double cells = 0.0;
  do {
    cells = 1.0;
    for (int c = 0; c < D; ++c) {
      count[c] = std::max(1.0, std::floor(box_.size[c] / width));
      cells *= count[c];
    }
    width *= 1.25;
  } while (cells > most);
  for (int c = 0; c < D; ++c) {
    count_[index(c)] = static_cast<std::int64_t>(count[c]);
    per_length_[index(c)] = count[c] / box_.size[c];
  }
  cell_count_ = static_cast<std::int64_t>(cells);
}

// Counting sort. Each thread has a range of the particles and its own counters, so the members of a cell come out ascending
// on any number of threads.
template <int D>
void CellList<D>::assign(double width, std::span<const Vec<D>> positions) {
  choose_cells(width, positions.size());
  const auto n = static_cast<std::int64_t>(positions.size());
  const auto cells = index(cell_count_);
  const std::int64_t parts = n > 4096 ? threads() : 1;
  start_.resize(cells + 1);
  member_.resize(positions.size());
  cell_.resize(positions.size());
  next_.resize(index(parts) * cells);
  const auto part = [&](std::int64_t k, const auto& visit) {
    std::int32_t* const next = next_.data() + index(k) * cells;
    for (std::int64_t i = k * n / parts; i < (k + 1) * n / parts; ++i) visit(next, index(i));
  };
#pragma omp parallel for schedule(static, 1) if (parts > 1)
  for (std::int64_t k = 0; k < parts; ++k) {
    std::fill_n(next_.data() + index(k) * cells, cells, 0);
    part(k, [&](std::int32_t* count, std::size_t i) {
      cell_[i] = static_cast<std::int32_t>(cell_of(positions[i]));
      ++count[cell_[i]];
    });
  }
  std::int32_t sum = 0;
  for (std::size_t cell = 0; cell < cells; ++cell) {
    start_[cell] = sum;
    for (std::size_t k = 0; k < index(parts); ++k) {
      const std::int32_t count = next_[k * cells + cell];
      next_[k * cells + cell] = sum;
      sum += count;
    }
  }
  start_[cells] = sum;
#pragma omp parallel for schedule(static, 1) if (parts > 1)
  for (std::int64_t k = 0; k < parts; ++k)
    part(k, [&](std::int32_t* next, std::size_t i) {
      member_[index(next[cell_[i]]++)] = static_cast<std::int32_t>(i);
    });
}

template <int D>
std::int64_t CellList<D>::cell_of(const Vec<D>& r) const {
  std::int64_t cell = 0;
  for (int c = D - 1; c >= 0; --c) {
    const std::int64_t n = count_[index(c)];
    const double x = r[c] * per_length_[index(c)];
    // Outside a bounded direction (or not a number): the border cell.
    const std::int64_t k =
        x > 0.0 ? static_cast<std::int64_t>(std::min(x, static_cast<double>(n - 1))) : 0;
    cell = cell * n + k;
  }
  return cell;
}

template <int D>
std::span<const std::int32_t> CellList<D>::members(std::int64_t cell) const {
  const auto b = index(start_[index(cell)]);
  const auto e = index(start_[index(cell) + 1]);
  return std::span<const std::int32_t>(member_).subspan(b, e - b);
}

template <int D>
void CellList<D>::neighbourhood(std::int64_t cell, std::vector<std::int64_t>& out) const {
  out.assign(1, 0);
  std::int64_t stride = 1;
  for (int c = 0; c < D; ++c) {
    const std::int64_t n = count_[index(c)];
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
    std::sort(order.begin() + first, order.end(),
              [&](std::int32_t a, std::int32_t b) { return id[index(a)] < id[index(b)]; });
  }
  return order;
}

template class CellList<2>;
template class CellList<3>;
template std::vector<std::int32_t> spatial_order<2>(const Box<2>&, double, std::span<const Vec<2>>,
                                                    std::span<const std::int64_t>);
template std::vector<std::int32_t> spatial_order<3>(const Box<3>&, double, std::span<const Vec<3>>,
                                                    std::span<const std::int64_t>);

}  // namespace odpd
