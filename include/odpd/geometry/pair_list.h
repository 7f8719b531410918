#pragma once
// Pairs closer than cutoff + skin (and a rounding error more), found with a cell list and reused until a particle has moved
// skin/2.
//
// Row i holds its partners j > i in ascending order. So the edges built from it (pairs closer than the cutoff,
// row by row) do not depend on when the list was made, and a restart needs no memory of it: the skin may be chosen, and
// changed, by what is cheapest.
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "odpd/core/communicator.h"
#include "odpd/geometry/box.h"

namespace odpd {

/// Particles sorted into cells at least `width` wide.
template <int D>
class CellList {
 public:
  CellList(const Box<D>& box, double width, std::span<const Vec<D>> positions);
  /// An empty one, for `assign`.
  explicit CellList(const Box<D>& box) : box_(box) {}
  /// Sorts these particles into cells of this width; memory is reused.
  void assign(double width, std::span<const Vec<D>> positions);
  std::int64_t cells() const { return cell_count_; }
  std::int64_t cell_of(const Vec<D>& r) const;
  /// Members of a cell, ascending.
  std::span<const std::int32_t> members(std::int64_t cell) const;
  /// The cell and its neighbours, each once, also where the box is one or two cells wide.
  void neighbourhood(std::int64_t cell, std::vector<std::int64_t>& out) const;
  /// Cells along each direction; a cell's number is x + count[0] (y + count[1] z).
  const std::array<std::int64_t, index(D)>& count() const { return count_; }
  /// All particles, cell after cell, and where each cell begins in them.
  std::span<const std::int32_t> sorted() const { return member_; }
  std::int32_t begin_of(std::int64_t cell) const { return start_[index(cell)]; }

 private:
  void choose_cells(double width, std::size_t particles);

  Box<D> box_;
  std::array<std::int64_t, index(D)> count_{};
  std::array<double, index(D)> per_length_{};  // cells per length
  std::int64_t cell_count_ = 1;
  std::vector<std::int32_t> start_, member_;
  std::vector<std::int32_t> cell_, next_;  // of each particle; free places of each thread and cell
};

template <int D>
class PairList {
 public:
  /// Throws ConfigError when a periodic direction is shorter than two cutoffs (nearest images would be
  /// ambiguous). cutoff and skin: length. Without a skin the list chooses it, as the particles move.
  PairList(const Box<D>& box, double cutoff, std::optional<double> skin = {});

  double cutoff() const { return cutoff_; }
  double skin() const { return skin_; }

  /// Makes the list valid for these positions (inside the box along periodic directions); true when it was
  /// rebuilt. `share`: the particles of this rank. All ranks call it together, and rebuild their lists together.
  bool update(std::span<const Vec<D>> positions, const Share& share = {});
  /// Forgets the list: particles were reordered, added or taken away.
  void invalidate() { reference_.clear(); }
  /// The same box with its sliding images elsewhere; the list is then searched anew.
  void slide(const Box<D>& box) {
    if (box.offset != box_.offset) invalidate();
    box_ = box;
  }

  std::int64_t rows() const { return static_cast<std::int64_t>(row_.size()); }
  std::int64_t pairs() const { return pairs_; }
  std::span<const std::int32_t> partners(std::int64_t row) const {
    const Row& r = row_[index(row)];
    return {found_[index(r.chunk)].data() + r.begin, index(r.length)};
  }
  std::int64_t rebuilds() const { return rebuilds_; }

 private:
  struct Row {
    std::int32_t chunk, begin, length;
  };
  double largest_displacement(std::span<const Vec<D>> positions, const Share& share) const;
  void choose_skin(double displacement_per_update);
  void rebuild(std::span<const Vec<D>> positions);
  void sort_positions(std::span<const Vec<D>> positions);
  void search_cells(std::int64_t chunk, double reach);

  Box<D> box_;
  double cutoff_, skin_;
  bool automatic_;
  std::vector<Vec<D>> reference_;  // positions at the last rebuild; empty: not kept, or not valid
  std::int64_t updates_ = 0;       // since the last rebuild
  std::int64_t rebuilds_ = 0;
  CellList<D> cells_;
  std::array<std::vector<double>, index(D)> x_;  // in the order of the cells
  std::vector<std::int32_t> index_;              // index in memory, likewise
  std::vector<Row> row_;
  std::vector<std::vector<std::int32_t>> found_;  // rows of a chunk of cells
  std::vector<std::int64_t> found_pairs_;
  std::int64_t pairs_ = 0;
};

/// Order of the particles along a path through cells of the given width that keeps neighbours close in memory:
/// result[k] is the index of the particle to come k-th. Ties by `id`, so the order is a function of the state.
template <int D>
std::vector<std::int32_t> spatial_order(const Box<D>& box, double width,
                                        std::span<const Vec<D>> positions,
                                        std::span<const std::int64_t> id);

}  // namespace odpd
