#pragma once
// The points of a regular grid over the box, padded so that every neighbour of a point lies at a fixed offset:
//
//   offset(k) = sum_c k_c stride_c,   k_c in {-1, 0, 1}
//
// A periodic direction has one ghost point at either end, a copy of the point at the other. A bounded one has none: the
// offset then leads to a point of the next line, and the stencil's entry for it is zero.
#include <array>
#include <cstdint>
#include <span>

#include "odpd/core/communicator.h"
#include "odpd/geometry/box.h"

namespace odpd {

template <int D>
struct GridShape {
  using Index = std::array<std::int64_t, index(D)>;
  static constexpr int corners = 1 << D;            ///< of a cell
  static constexpr int entries = D == 2 ? 9 : 27;   ///< of a stencil
  static constexpr int triangle = D * (D + 1) / 2;  ///< of a symmetric D x D block

  Vec<D> low{};         ///< the first point's position
  Vec<D> length{};      ///< cells times spacing
  Index cells{};        ///< per direction
  Vec<D> per_length{};  ///< cells / length
  std::array<bool, index(D)> periodic{};

  GridShape() = default;
  GridShape(const Vec<D>& origin, const Vec<D>& lengths, const Index& cells_per_direction,
            const std::array<bool, index(D)>& is_periodic);

  std::int64_t points(int c) const { return cells[at(c)] + (periodic[at(c)] ? 0 : 1); }
  std::int64_t points() const;
  std::int64_t stride(int c) const { return stride_[at(c)]; }
  std::int64_t total() const { return total_; }  ///< points and ghosts
  std::int64_t groups() const { return (total_ + 15) / 16; }
  std::int64_t margin() const {
    return margin_;
  }  ///< floats to keep free before and after a vector
  /// Floats of one component of a grid vector, its margins included.
  std::int64_t pitch() const { return 2 * margin_ + 16 * groups(); }
  /// Number of a point in arrays; -1 and points(c) name the ghosts of a periodic direction.
  std::int64_t number_of(const Index& point) const;
  /// Offset of a stencil entry, x fastest, each direction -1, 0, 1.
  std::int64_t entry_offset(int entry) const;
  /// Offset of a corner of a cell from its lowest one, x fastest.
  std::int64_t corner_offset(int corner) const;
  /// Twice the spacing in every direction where the number of cells is even.
  GridShape coarser() const;
  bool coarsened(int c) const { return cells[at(c)] % 2 == 0; }

 private:
  static std::size_t at(int c) { return index(c); }
  Index stride_{};
  std::int64_t total_ = 0, margin_ = 0, origin_ = 0;
};

/// A grid over the box, in bounded directions over what the positions (D per node) take of it, with a spacing near
/// `spacing` and numbers of cells that can be halved several times. `share`: which nodes are this rank's; all ranks call it
/// together and get the same grid.
template <int D>
GridShape<D> choose_grid(const Box<D>& box, std::span<const double> positions, double spacing,
                         const Share& share = {});

/// Calls f(point) for every point of the grid, x fastest.
template <int D, class F>
void for_each_point(const GridShape<D>& shape, const F& f) {
  typename GridShape<D>::Index point{};
  const std::int64_t n = shape.points();
  for (std::int64_t k = 0; k < n; ++k) {
    f(point);
    for (int c = 0; c < D; ++c) {
      auto& x = point[index(c)];
      if (++x < shape.points(c)) break;
      x = 0;
    }
  }
}

}  // namespace odpd
