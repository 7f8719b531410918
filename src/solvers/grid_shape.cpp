#include "odpd/solvers/grid_shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "odpd/core/index.h"

namespace odpd {

template <int D>
GridShape<D>::GridShape(const Vec<D>& origin, const Vec<D>& lengths,
                        const Index& cells_per_direction,
                        const std::array<bool, index(D)>& is_periodic)
    : low(origin), length(lengths), cells(cells_per_direction), periodic(is_periodic), total_(1) {
  for (int c = 0; c < D; ++c) {
    const std::int64_t ghosts = periodic[at(c)] ? 1 : 0;
    stride_[at(c)] = total_;
    per_length[c] = static_cast<double>(cells[at(c)]) / length[c];
    origin_ += ghosts * total_;
    margin_ += total_;
    total_ *= points(c) + 2 * ghosts;
  }
  margin_ = (margin_ + 15) / 16 * 16;
}

template <int D>
std::int64_t GridShape<D>::points() const {
  std::int64_t n = 1;
  for (int c = 0; c < D; ++c) n *= points(c);
  return n;
}

template <int D>
std::int64_t GridShape<D>::number_of(const Index& point) const {
  std::int64_t p = origin_;
  for (int c = 0; c < D; ++c) p += point[at(c)] * stride_[at(c)];
  return p;
}

template <int D>
std::int64_t GridShape<D>::entry_offset(int entry) const {
  std::int64_t offset = 0;
  for (int c = 0; c < D; ++c, entry /= 3) offset += (entry % 3 - 1) * stride_[at(c)];
  return offset;
}

template <int D>
std::int64_t GridShape<D>::corner_offset(int corner) const {
  std::int64_t offset = 0;
  for (int c = 0; c < D; ++c, corner /= 2) offset += (corner % 2) * stride_[at(c)];
  return offset;
}

template <int D>
GridShape<D> GridShape<D>::coarser() const {
  Index half = cells;
  for (int c = 0; c < D; ++c)
    if (coarsened(c)) half[at(c)] /= 2;
  return GridShape(low, length, half, periodic);
}

template <int D>
GridShape<D> choose_grid(const Box<D>& box, std::span<const double> positions, double spacing,
                         const Share& share) {
  typename GridShape<D>::Index cells{};
  Vec<D> low{}, length = box.size;
  for (int c = 0; c < D; ++c) {
    if (!box.is_periodic(c) && !positions.empty()) {
      const auto first = index(c);
      const std::span<const double> own = share.part(positions, D);
      double least = std::numeric_limits<double>::infinity(), most = -least;
      for (std::size_t k = first; k < own.size(); k += D) {
        least = std::min(least, own[k]);
        most = std::max(most, own[k]);
      }
      least = share.ranks->smallest(least);
      most = share.ranks->largest(most);
      low[c] = least;
      length[c] = std::max(most - least, 1e-6 * box.size[c]);
    }
    const double wanted = std::max(length[c] / spacing, 1.0);
    // What is left after halving costs a dense solve: 1 to 3 are as good as free.
    const auto misfit = [wanted](std::int64_t n) {
      std::int64_t odd = n;
      while (odd % 2 == 0) odd /= 2;
      const double size = std::log(static_cast<double>(n) / wanted);
      return std::abs(size) + (odd > 3 ? 0.04 * static_cast<double>(odd) : 0.0);
    };
    std::int64_t best = std::max<std::int64_t>(1, static_cast<std::int64_t>(wanted));
    for (std::int64_t n = std::max<std::int64_t>(1, best * 3 / 4); n <= best * 4 / 3 + 1; ++n)
      if (misfit(n) < misfit(best)) best = n;
    cells[index(c)] = best;
  }
  return GridShape<D>(low, length, cells, box.periodic);
}

template struct GridShape<2>;
template struct GridShape<3>;
template GridShape<2> choose_grid<2>(const Box<2>&, std::span<const double>, double, const Share&);
template GridShape<3> choose_grid<3>(const Box<3>&, std::span<const double>, double, const Share&);

}  // namespace odpd
