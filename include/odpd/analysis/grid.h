#pragma once
// A grid of equal cells over the space between the wall surfaces.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "odpd/core/index.h"
#include "odpd/scene/scene.h"

namespace odpd {

template <int D>
struct Grid {
  using Counts = std::array<std::int64_t, index(D)>;

  Grid(const Counts& cells, const Scene<D>& scene)
      : counts(cells), low(scene.fluid_low()), high(scene.fluid_high()) {}

  std::size_t cells() const {
    std::size_t n = 1;
    for (const std::int64_t c : counts) n *= index(c);
    return n;
  }
  std::int64_t count(int c) const { return counts[index(c)]; }
  double spacing(int c) const { return (high[c] - low[c]) / static_cast<double>(count(c)); }
  double cell_volume() const {
    double v = 1.0;
    for (int c = 0; c < D; ++c) v *= spacing(c);
    return v;
  }
  /// Cell of a point, x fastest; points behind a surface belong to the cell next to it.
  std::size_t cell_of(const Vec<D>& r) const {
    std::int64_t cell = 0;
    for (int c = D - 1; c >= 0; --c)
      cell = cell * count(c) +
             std::clamp<std::int64_t>(
                 static_cast<std::int64_t>(std::floor((r[c] - low[c]) / (high[c] - low[c]) *
                                                      static_cast<double>(count(c)))),
                 0, count(c) - 1);
    return index(cell);
  }
  /// Steps of a cell's index along c, and its place there.
  std::int64_t stride(int c) const {
    std::int64_t s = 1;
    for (int b = 0; b < c; ++b) s *= count(b);
    return s;
  }
  std::int64_t coordinate(std::size_t cell, int c) const {
    return static_cast<std::int64_t>(cell) / stride(c) % count(c);
  }

  Counts counts;
  Vec<D> low, high;
};

}  // namespace odpd
