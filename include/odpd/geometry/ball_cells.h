#pragma once
// Balls in a box, sorted into cells, to be asked for those that a place r comes near:
//
//   |r - x_k| <= distance + R_k   for the nearest images
//
// They may be added and moved one by one and be of any sizes: those of like size (a factor of two) share a grid, so that a
// few large ones do not make the cells of many small ones wide.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "odpd/geometry/box.h"

namespace odpd {

template <int D>
class BallCells {
 public:
  explicit BallCells(const Box<D>& box) : box_(box) {}

  std::size_t size() const { return balls_.size(); }
  const Vec<D>& centre(std::size_t k) const { return balls_[k].centre; }
  double radius(std::size_t k) const { return balls_[k].radius; }

  /// A ball more, which is number size() - 1 from now on. A radius may be zero (a point), also negative.
  void add(const Vec<D>& centre, double radius);
  void move(std::size_t k, const Vec<D>& centre);

  /// Calls found(k) for all k as above, and for some further ones, each once and in no particular order, until it returns
  /// true; whether it did. So found looks itself how far away they are.
  template <class Found>
  bool find_near(const Vec<D>& r, double distance, const Found& found) const {
    const Vec<D> s = grid_place(r);
    return std::any_of(grids_.begin(), grids_.end(), [&](const Grid& grid) {
      return find_in(grid, s, std::max(distance + grid.largest, 0.0), found);
    });
  }
  /// Whether a ball at r overlaps with one of these (not: touches it), but for number `self`.
  bool overlaps(const Vec<D>& r, double radius, std::size_t self = SIZE_MAX) const {
    return find_near(r, radius, [&](std::size_t k) {
      return k != self &&
             norm(box_.separation(r, centre(k))) < std::max(radius + balls_[k].radius, 0.0);
    });
  }

 private:
  struct Ball {
    Vec<D> centre;
    double radius;
    std::size_t grid, cell;
    std::int32_t next;  // in its cell, -1 at the end
  };
  struct Grid {
    int exponent;                                // of the radii: [2^e, 2^(e+1))
    double largest;                              // radius
    std::size_t size = 0;                        // balls
    std::size_t room = 0;                        // balls for which the cells were chosen
    std::array<std::int64_t, index(D)> count{};  // cells along each direction
    std::vector<std::int32_t> first;             // of each cell, -1 where it is empty
  };

  // In coordinates in which images are `size` apart.
  Vec<D> grid_place(Vec<D> r) const {
    box_.wrap(r);
    return box_.straightened(r);
  }
  double cell_coordinate(const Grid& grid, double s, int c) const {
    return std::floor(s / box_.size[c] * static_cast<double>(grid.count[index(c)]));
  }
  std::size_t cell_of(const Grid& grid, const Vec<D>& centre) const;
  void choose_cells(std::size_t g);
  void insert(std::size_t k);

  // Cells first, first + 1, ... of `count` along one direction, the last followed by number 0.
  struct Range {
    std::int64_t first, length;
  };
  Range range(const Grid& grid, double s, double distance, int c) const {
    const std::int64_t n = grid.count[index(c)];
    const auto last = static_cast<double>(n - 1);
    // A sheared cell's coordinate along the flow mixes two directions.
    const double slope =
        box_.shear && c == box_.shear->flow ? box_.offset / box_.size[box_.shear->gradient] : 0.0;
    // Rounding of the coordinates must not lose a ball that just touches.
    const double reach =
        std::sqrt(1.0 + slope * slope) * (1.0 + 1e-9) * distance + 1e-12 * box_.size[c];
    double low = cell_coordinate(grid, s - reach, c), high = cell_coordinate(grid, s + reach, c);
    if (!box_.is_periodic(c)) {
      low = std::clamp(low, 0.0, last);
      high = std::clamp(high, 0.0, last);
    }
    if (!(high - low < last)) return {0, n};
    const auto k = static_cast<std::int64_t>(low);
    return {k < 0 ? k + n : k, static_cast<std::int64_t>(high - low) + 1};
  }

  template <class Found>
  bool find_in(const Grid& grid, const Vec<D>& s, double distance, const Found& found) const {
    std::array<Range, index(D)> ranges;
    std::int64_t lines = 1;
    for (int c = 0; c < D; ++c) {
      ranges[index(c)] = range(grid, s[c], distance, c);
      if (c > 0) lines *= ranges[index(c)].length;
    }
    const std::int64_t n_x = grid.count[0], end = ranges[0].first + ranges[0].length;
    for (std::int64_t line = 0; line < lines; ++line) {
      std::int64_t rest = line, before = 0, stride = n_x;
      for (std::size_t c = 1; c < D; ++c) {
        const std::int64_t k = ranges[c].first + rest % ranges[c].length;
        before += (k < grid.count[c] ? k : k - grid.count[c]) * stride;
        rest /= ranges[c].length;
        stride *= grid.count[c];
      }
      for (std::int64_t x = ranges[0].first; x < end; ++x)
        for (std::int32_t k = grid.first[index(before + (x < n_x ? x : x - n_x))]; k >= 0;
             k = balls_[index(k)].next)
          if (found(index(k))) return true;
    }
    return false;
  }

  Box<D> box_;
  std::vector<Ball> balls_;
  std::vector<Grid> grids_;
};

}  // namespace odpd
