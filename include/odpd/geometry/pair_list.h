#pragma once
// Pairs closer than cutoff + skin, found with a cell list and reused until a particle has moved skin/2.
//
// Row i holds its partners j > i in ascending order. So the edges built from it (pairs closer than the cutoff,
// row by row) do not depend on when the list was made, and a restart needs no memory of it.
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/geometry/box.h"

namespace odpd {

/// Particles sorted into cells at least `width` wide.
template <int D>
class CellList {
 public:
  CellList(const Box<D>& box, double width, std::span<const Vec<D>> positions);
  std::int64_t cells() const { return cell_count_; }
  std::int64_t cell_of(const Vec<D>& r) const;
  /// Members of a cell, ascending.
  std::span<const std::int32_t> members(std::int64_t cell) const;
  /// The cell and its neighbours, each once, also where the box is one or two cells wide.
  void neighbourhood(std::int64_t cell, std::vector<std::int64_t>& out) const;

 private:
  Box<D> box_;
  std::array<std::int64_t, static_cast<std::size_t>(D)> count_{};
  std::int64_t cell_count_ = 1;
  std::vector<std::int32_t> start_, member_;
};

template <int D>
class PairList {
 public:
  /// Throws ConfigError when a periodic direction is shorter than two cutoffs (nearest images would be
  /// ambiguous). cutoff and skin: length.
  PairList(const Box<D>& box, double cutoff, double skin);

  double cutoff() const { return cutoff_; }
  double skin() const { return skin_; }

  /// Makes the list valid for these positions (inside the box along periodic directions); true when it was
  /// rebuilt.
  bool update(std::span<const Vec<D>> positions);
  /// Forgets the list: particles were reordered, added or taken away.
  void invalidate() { reference_.clear(); }

  std::int64_t rows() const { return static_cast<std::int64_t>(start_.size()) - 1; }
  std::int64_t pairs() const { return static_cast<std::int64_t>(partner_.size()); }
  std::span<const std::int32_t> partners(std::int64_t row) const {
    const auto b = static_cast<std::size_t>(start_[static_cast<std::size_t>(row)]);
    const auto e = static_cast<std::size_t>(start_[static_cast<std::size_t>(row) + 1]);
    return std::span<const std::int32_t>(partner_).subspan(b, e - b);
  }
  std::int64_t rebuilds() const { return rebuilds_; }

 private:
  bool valid_for(std::span<const Vec<D>> positions) const;
  void rebuild(std::span<const Vec<D>> positions);

  Box<D> box_;
  double cutoff_, skin_;
  std::vector<Vec<D>> reference_;
  std::vector<std::int64_t> start_{0};
  std::vector<std::int32_t> partner_;
  std::int64_t rebuilds_ = 0;
};

/// Order of the particles along a path through cells of the given width that keeps neighbours close in memory:
/// result[k] is the index of the particle to come k-th. Ties by `id`, so the order is a function of the state.
template <int D>
std::vector<std::int32_t> spatial_order(const Box<D>& box, double width,
                                        std::span<const Vec<D>> positions,
                                        std::span<const std::int64_t> id);

}  // namespace odpd
