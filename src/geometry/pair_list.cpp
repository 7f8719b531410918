#include "odpd/geometry/pair_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/isa.h"
#include "odpd/core/parallel.h"
#include "pair_search_kernels.h"

namespace odpd {

namespace {

// Cells searched as one piece of work, with one buffer for the rows found.
constexpr std::int64_t chunk_cells = 64;
// Entries a kernel may read, or write, beyond the last one.
constexpr std::size_t spare = 64;
// Cells around a cell; across a sliding face four along the flow.
constexpr std::size_t most_runs = 36;

template <int D>
kernels::PairSearchKernels::Search* search_kernel() {
  using namespace kernels;
  const PairSearchKernels& table =
      for_isa(pair_search_portable, pair_search_avx2, pair_search_avx512);
  if constexpr (D == 2) return table.plane;
  return table.space;
}

struct Neighbour {
  std::int64_t cell;  // along one direction
  double shift;       // what its particles are moved by
};

// The cells k - 1, k and k + 1 of n along a direction of this length, moved to where they are seen from k. Those of a box one
// or two cells wide come as two images.
std::array<Neighbour, 3> neighbours(std::int64_t k, std::int64_t n, bool periodic, double length,
                                    std::size_t& size) {
  std::array<Neighbour, 3> out{};
  size = 0;
  for (std::int64_t cell = k - 1; cell <= k + 1; ++cell) {
    if (cell >= 0 && cell < n) {
      out[size++] = {cell, 0.0};
    } else if (periodic) {
      out[size++] = {cell < 0 ? cell + n : cell - n, cell < 0 ? -length : length};
    }
  }
  return out;
}

// Everything around a cell, as few runs of particles: neighbours along x follow each other in memory.
template <int D>
int candidate_runs(const CellList<D>& cells, const Box<D>& box, std::int64_t cell,
                   std::array<kernels::CandidateRun, most_runs>& runs) {
  struct Line {
    std::int64_t first;  // number of its cell at x = 0
    double shift[3];
  };
  std::array<Line, 9> lines{};
  std::size_t n_lines = 1, size = 0;
  const std::int64_t nx = cells.count()[0];
  std::int64_t rest = cell / nx, stride = nx;
  for (std::size_t c = 1; c < D; ++c) {
    const std::int64_t n = cells.count()[c];
    const auto around = neighbours(rest % n, n, box.periodic[c], box.size.x[c], size);
    std::array<Line, 9> more{};
    std::size_t n_more = 0;
    for (std::size_t k = 0; k < size; ++k)
      for (std::size_t l = 0; l < n_lines; ++l) {
        more[n_more] = lines[l];
        more[n_more].first += around[k].cell * stride;
        more[n_more++].shift[c] = around[k].shift;
      }
    lines = more;
    n_lines = n_more;
    rest /= n;
    stride *= n;
  }
  const auto around = neighbours(cell % nx, nx, box.periodic[0], box.size.x[0], size);
  int n_runs = 0;
  for (std::size_t l = 0; l < n_lines; ++l) {
    const int before = n_runs;
    for (std::size_t k = 0; k < size; ++k) {
      const std::int64_t here = lines[l].first + around[k].cell;
      const std::int32_t begin = cells.begin_of(here), end = cells.begin_of(here + 1);
      if (begin == end) continue;
      auto* last = n_runs > before ? &runs[index(n_runs) - 1] : nullptr;
      if (last != nullptr && last->end == begin && around[k].shift == last->shift[0]) {
        last->end = end;
      } else {
        runs[index(n_runs++)] = {
            begin, end, {around[k].shift, lines[l].shift[1], lines[l].shift[2]}};
      }
    }
  }
  return n_runs;
}

// A cell as it is seen from another one.
struct SeenCell {
  std::int64_t cell;  // number
  double shift[3];
};

// The same along one direction: adds the cells first <= k <= last of n, those outside as images.
void add_line(const SeenCell& from, std::int64_t first, std::int64_t last, std::int64_t n,
              std::int64_t stride, std::size_t c, bool periodic, double length,
              std::vector<SeenCell>& out) {
  for (std::int64_t k = first; k <= last; ++k) {
    const std::int64_t image = k >= 0 ? k / n : -((n - 1 - k) / n);
    if (image != 0 && !periodic) continue;
    SeenCell cell = from;
    cell.cell += (k - image * n) * stride;
    cell.shift[c] += static_cast<double>(image) * length;
    out.push_back(cell);
  }
}

// The runs of a cell at a face of the box whose images slide. Those cells lie anywhere along the flow, so that they overlap
// with up to four.
template <int D>
int candidate_runs_across(const CellList<D>& cells, const Box<D>& box, std::int64_t cell,
                          std::span<kernels::CandidateRun> runs) {
  const auto flow = index(box.shear->flow), gradient = index(box.shear->gradient);
  std::array<std::int64_t, index(D)> place{}, stride{};
  std::int64_t rest = cell, cells_before = 1;
  for (std::size_t c = 0; c < D; ++c) {
    place[c] = rest % cells.count()[c];
    rest /= cells.count()[c];
    stride[c] = cells_before;
    cells_before *= cells.count()[c];
  }
  std::vector<SeenCell> seen, more;
  add_line({0, {}}, place[gradient] - 1, place[gradient] + 1, cells.count()[gradient],
           stride[gradient], gradient, true, box.size.x[gradient], seen);
  // x comes last, as its cells follow each other in memory.
  for (std::size_t c = D; c-- > 0;) {
    if (c == gradient) continue;
    more.clear();
    for (SeenCell& from : seen) {
      double cells_off = 0.0;
      if (c == flow) {
        const double offset = from.shift[gradient] / box.size.x[gradient] * box.offset;
        from.shift[c] += offset;
        cells_off = offset / box.size.x[c] * static_cast<double>(cells.count()[c]);
      }
      add_line(from, place[c] - 1 - static_cast<std::int64_t>(std::ceil(cells_off)),
               place[c] + 1 - static_cast<std::int64_t>(std::floor(cells_off)), cells.count()[c],
               stride[c], c, box.periodic[c], box.size.x[c], more);
    }
    seen.swap(more);
  }
  std::size_t n_runs = 0;
  for (const SeenCell& s : seen) {
    const std::int32_t begin = cells.begin_of(s.cell), end = cells.begin_of(s.cell + 1);
    if (begin == end) continue;
    auto* last = n_runs > 0 ? &runs[n_runs - 1] : nullptr;
    if (last != nullptr && last->end == begin && std::equal(s.shift, s.shift + 3, last->shift)) {
      last->end = end;
    } else {
      runs[n_runs++] = {begin, end, {s.shift[0], s.shift[1], s.shift[2]}};
    }
  }
  return static_cast<int>(n_runs);
}

// The cell lies at a face that slides.
template <int D>
bool at_sliding_face(const CellList<D>& cells, const Box<D>& box, std::int64_t cell) {
  if (!box.shear) return false;
  const auto gradient = index(box.shear->gradient);
  for (std::size_t c = 0; c < gradient; ++c) cell /= cells.count()[c];
  const std::int64_t k = cell % cells.count()[gradient];
  return k == 0 || k == cells.count()[gradient] - 1;
}

}  // namespace

template <int D>
PairList<D>::PairList(const Box<D>& box, double cutoff, std::optional<double> skin)
    : box_(box),
      cutoff_(cutoff),
      skin_(skin.value_or(0.0)),
      automatic_(!skin.has_value()),
      cells_(box) {
  isa();  // a wrong ODPD_ISA is an error here, where it can be caught, not on a thread
  for (int c = 0; c < D; ++c)
    if (box.is_periodic(c) && box.size[c] < 2.0 * cutoff)
      throw ConfigError(
          fmt::format("the box is {} long in direction {}, which is periodic: it must be at least "
                      "two cutoffs ({}), or a "
                      "particle would see a neighbour twice; enlarge box.size",
                      box.size[c], "xyz"[c], 2.0 * cutoff));
}

template <int D>
double PairList<D>::largest_displacement(std::span<const Vec<D>> positions,
                                         const Share& share) const {
  constexpr std::int64_t block = 4096;
  const auto n = static_cast<std::int64_t>(positions.size());
  std::vector<double> square(index((n + block - 1) / block));
  parallel_ranges(n, block, [&](std::int64_t begin, std::int64_t end) {
    double most = 0.0;
    for (auto i = index(std::max(begin, share.first)); i < index(share.end(end)); ++i) {
      const Vec<D> d = box_.separation(positions[i], reference_[i]);
      // A coordinate that is no number is infinitely far away.
      most = dot(d, d) <= most ? most : dot(d, d) > most ? dot(d, d) : HUGE_VAL;
    }
    square[index(begin / block)] = most;
  });
  double most = 0.0;
  for (const double s : square) most = std::max(most, s);
  return std::sqrt(most);
}

template <int D>
bool PairList<D>::update(std::span<const Vec<D>> positions, const Share& share) {
  ++updates_;
  if (!reference_.empty() && reference_.size() == positions.size()) {
    const double displacement = share.ranks->largest(largest_displacement(positions, share));
    if (displacement <= 0.5 * skin_ && skin_ > 0.0) return false;
    if (automatic_) choose_skin(displacement / static_cast<double>(updates_));
  }
  rebuild(positions);
  updates_ = 0;
  ++rebuilds_;
  // Without a skin the positions serve to measure the motion, which changes slowly.
  const bool needed = skin_ > 0.0 || (automatic_ && rebuilds_ % 32 == 1);
  if (needed) {
    reference_.assign(positions.begin(), positions.end());
  } else {
    reference_.clear();
  }
  return true;
}

template <int D>
void PairList<D>::sort_positions(std::span<const Vec<D>> positions) {
  const auto sorted = cells_.sorted();
  for (auto& column : x_) column.resize(positions.size() + spare);
  index_.resize(positions.size() + spare);
  parallel_for(static_cast<std::int64_t>(positions.size()), [&](std::int64_t place) {
    const auto k = index(place);
    const auto i = index(sorted[k]);
    for (std::size_t c = 0; c < D; ++c) x_[c][k] = positions[i].x[c];
    index_[k] = sorted[k];
  });
}

template <int D>
void PairList<D>::search_cells(std::int64_t chunk, double reach) {
  auto& found = found_[index(chunk)];
  kernels::SortedParticles particles{{}, index_.data()};
  for (std::size_t c = 0; c < D; ++c) particles.x[c] = x_[c].data();
  bool twice = false;
  for (int c = 0; c < D; ++c) twice = twice || (box_.is_periodic(c) && box_.size[c] <= 2.0 * reach);
  auto* const search = search_kernel<D>();
  std::array<kernels::CandidateRun, most_runs> runs;
  std::array<std::int32_t, 64> length;
  std::size_t used = 0;
  std::int64_t pairs = 0;
  const std::int64_t end = std::min(cells_.cells(), (chunk + 1) * chunk_cells);
  for (std::int64_t cell = chunk * chunk_cells; cell < end; ++cell) {
    const std::int32_t last = cells_.begin_of(cell + 1);
    if (cells_.begin_of(cell) == last) continue;
    const int n_runs = at_sliding_face(cells_, box_, cell)
                           ? candidate_runs_across<D>(cells_, box_, cell, runs)
                           : candidate_runs(cells_, box_, cell, runs);
    std::int64_t candidates = 0;
    for (int r = 0; r < n_runs; ++r) candidates += runs[index(r)].end - runs[index(r)].begin;
    const auto batch =
        static_cast<std::int32_t>(std::clamp<std::int64_t>(65536 / candidates, 1, 64));
    for (std::int32_t k = cells_.begin_of(cell); k < last; k += batch) {
      const std::int32_t stop = std::min(last, k + batch);
      const std::size_t room = used + index((stop - k) * candidates) + spare;
      if (found.size() < room) found.resize(std::max(room, 3 * found.size() / 2));
      search(particles, k, stop, runs.data(), n_runs, reach * reach, !twice, found.data() + used,
             length.data());
      for (std::int32_t member = k; member < stop; ++member) {
        const std::int32_t n = length[index(member - k)];
        std::int32_t* const row = found.data() + used;
        if (twice || n > kernels::longest_sorted_row) std::sort(row, row + n);
        const auto different =
            twice ? static_cast<std::int32_t>(std::unique(row, row + n) - row) : n;
        row_[index(index_[index(member)])] = {static_cast<std::int32_t>(chunk),
                                              static_cast<std::int32_t>(used), different};
        pairs += different;
        used += index(n);
      }
    }
  }
  found_pairs_[index(chunk)] = pairs;
}

template <int D>
void PairList<D>::rebuild(std::span<const Vec<D>> positions) {
  // Shifted images round differently from Box::separation: pairs at the edge are taken in, models look again.
  const double reach = (cutoff_ + skin_) * (1.0 + 1e-9);
  cells_.assign(reach, positions);
  sort_positions(positions);
  row_.resize(positions.size());
  const std::int64_t chunks = (cells_.cells() + chunk_cells - 1) / chunk_cells;
  if (found_.size() < index(chunks)) found_.resize(index(chunks));
  found_pairs_.assign(index(chunks), 0);
#pragma omp parallel for schedule(dynamic) if (threads() > 1)
  for (std::int64_t chunk = 0; chunk < chunks; ++chunk) search_cells(chunk, reach);
  pairs_ = 0;
  for (const std::int64_t pairs : found_pairs_) pairs_ += pairs;
}

// Cost of an update, search and edges, with a list that lives m of them, in units of that without skin, as measured in 3D at
// density 4: a search takes 0.55, the edges 0.45, to find them among the pairs of a list 0.25 for its share at no skin.
template <int D>
void PairList<D>::choose_skin(double displacement_per_update) {
  double best = 1.0;
  skin_ = 0.0;
  for (const int updates : {4, 8, 16, 32, 64, 128}) {
    const double skin = 2.1 * displacement_per_update * updates;
    const double cost =
        std::pow(1.0 + skin / cutoff_, D) * (0.55 / static_cast<double>(updates) + 0.25) + 0.45;
    if (!(cost < best)) continue;
    best = cost;
    skin_ = skin;
  }
}

template class PairList<2>;
template class PairList<3>;

}  // namespace odpd
