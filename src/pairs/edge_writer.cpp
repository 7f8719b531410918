#include "odpd/pairs/edge_writer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "edge_kernels.h"
#include "odpd/core/index.h"
#include "odpd/core/isa.h"
#include "odpd/core/parallel.h"
#include "odpd/pairs/density_writer.h"

namespace odpd {

namespace {

constexpr std::int64_t rows_per_block = 64;
constexpr auto block = index(kernels::edge_block);

// Differences of positions of some pairs, and their squares.
template <int D>
struct Differences {
  double d[3][block], square[block];
  double* const column[3] = {d[0], d[1], d[2]};
  std::size_t size = 0;

  void add(const Vec<D>& a, const Vec<D>& b) {
    for (std::size_t c = 0; c < D; ++c) d[c][size] = a.x[c] - b.x[c];
    ++size;
  }
  // Of the nearest images; the last vector is filled up with copies of the last pair.
  void close(const kernels::EdgeKernels& kernel, const kernels::Images& images, const Box<D>& box) {
    if (box.shear) slide(box);
    for (std::size_t k = size; k % 8 != 0; ++k)
      for (std::size_t c = 0; c < D; ++c) d[c][k] = d[c][size - 1];
    kernel.separations(D, images, static_cast<int>(size), column, square);
  }
  // The offset of what is seen across a sliding face, before Box::separation's other steps.
  void slide(const Box<D>& box) {
    double* const along = d[index(box.shear->flow)];
    const double* const across = d[index(box.shear->gradient)];
    const double half = 0.5 * box.size[box.shear->gradient];
    for (std::size_t k = 0; k < size; ++k)
      along[k] -= across[k] > half ? box.offset : across[k] < -half ? -box.offset : 0.0;
  }
};

// Which pairs of the list become edges: those that may move relative to each other, or all others.
enum class Pairs { moving, rigid };

template <int D>
class Writer {
 public:
  using Fill = std::function<void(PairNetwork<D>&, std::size_t, std::size_t)>;

  Writer(const PairList<D>& list, double cutoff, const Box<D>& box,
         std::span<const Vec<D>> positions, const Particles<D>& particles, const Fill& fill,
         PairNetwork<D>& network, Pairs wanted, std::span<const double> reaches)
      : kernel_(for_isa(kernels::edge_portable, kernels::edge_avx2, kernels::edge_avx512)),
        list_(list),
        reach2_(cutoff * cutoff),
        positions_(positions),
        particles_(particles),
        fill_(fill),
        network_(network),
        box_(box),
        wanted_(wanted) {
    for (std::size_t c = 0; c < D; ++c) {
      images_.length[c] = box.size.x[c];
      images_.half[c] =
          box.periodic[c] ? 0.5 * box.size.x[c] : std::numeric_limits<double>::infinity();
    }
    // Where all reach as far as the cutoff there is nothing to look up.
    if (std::any_of(reaches.begin(), reaches.end(), [&](double r) { return r < cutoff; }))
      for (const double r : reaches) reaches2_.push_back(r * r);
    species_ = std::llround(std::sqrt(static_cast<double>(reaches2_.size())));
    network_.particles = list.rows();
    network_.first.resize(index(list.rows()) + 1);
  }

  void write() {
    const bool known = std::any_of(particles_.group.begin(), particles_.group.end(),
                                   [](Group group) { return !group.is_free(); });
    if (wanted_ == Pairs::rigid && !known) return network_.resize(0);
    // A list without skin has the edges themselves and the rigid pairs, but for a pair at the cutoff, to rounding; where some
    // species reach less far it has more.
    if (list_.skin() > 0.0 || !reaches2_.empty() || wanted_ == Pairs::rigid ||
        !write_all(known ? Rows::within : Rows::whole))
      write_all(Rows::near);
    if (wanted_ == Pairs::moving) network_.index_rows();
  }

 private:
  // Of a row of the list: all pairs, those that are wanted, or of these those closer than the cutoff.
  enum class Rows { whole, within, near };

  bool write_all(Rows rows) {
    if (rows != Rows::whole) find_contacts(rows);
    return write_rows([&](std::int64_t p) {
      if (is_whole(index(p), rows)) return list_.partners(p);
      return std::span<const std::int32_t>(network_.scratch)
          .subspan(index(candidates_[index(p)]), index(contacts_[index(p)]));
    });
  }

  // A free particle has no rigid pairs.
  bool is_whole(std::size_t p, Rows rows) const {
    return rows == Rows::whole || (rows == Rows::within && particles_.is_free(p));
  }

  // Partners of each particle to `scratch`, where the list's row begins in it.
  void find_contacts(Rows rows) {
    const auto n = index(list_.rows());
    candidates_.assign(n + 1, 0);
    contacts_.assign(n, 0);
    for (std::size_t p = 0; p < n; ++p)
      candidates_[p + 1] =
          candidates_[p] + static_cast<std::int64_t>(candidates_of(p, rows).size());
    if (network_.scratch.size() < index(candidates_.back()))
      network_.scratch.resize(index(candidates_.back()));
    parallel_ranges(list_.rows(), rows_per_block, [&](std::int64_t begin, std::int64_t end) {
      Differences<D> pairs;
      for (std::int64_t p = begin; p < end; ++p) find_contacts_of(index(p), rows, pairs);
    });
  }

  std::span<const std::int32_t> candidates_of(std::size_t p, Rows rows) const {
    if (is_whole(p, rows) || (wanted_ == Pairs::rigid && particles_.is_free(p))) return {};
    return list_.partners(static_cast<std::int64_t>(p));
  }

  void find_contacts_of(std::size_t p, Rows rows, Differences<D>& pairs) {
    const auto partners = candidates_of(p, rows);
    const bool moving = wanted_ == Pairs::moving;
    std::int32_t* out = network_.scratch.data() + candidates_[p];
    const auto take = [&](std::int32_t q, bool near) {
      const bool moves = !rigid_pair(particles_.group[p], particles_.group[index(q)]);
      *out = q;  // never beyond the row: as many were read
      if (near && moves == moving) ++out;
    };
    if (rows == Rows::within) {
      for (const std::int32_t q : partners) take(q, true);
    } else {
      for (std::size_t k = 0; k < partners.size(); k += block) {
        const auto some = partners.subspan(k, std::min(block, partners.size() - k));
        pairs.size = 0;
        for (const std::int32_t q : some) pairs.add(positions_[p], positions_[index(q)]);
        pairs.close(kernel_, images_, box_);
        for (std::size_t l = 0; l < some.size(); ++l)
          take(some[l], pairs.square[l] < reach2_of(p, index(some[l])));
      }
    }
    contacts_[p] = static_cast<std::int32_t>(out - (network_.scratch.data() + candidates_[p]));
  }

  double reach2_of(std::size_t p, std::size_t q) const {
    if (reaches2_.empty()) return reach2_;
    return reaches2_[index(particles_.species[p] * species_ + particles_.species[q])];
  }

  // Writes all edges, given the partners of each particle. False when some are not closer than the cutoff.
  template <class Partners>
  bool write_rows(const Partners& partners) {
    const auto n = index(list_.rows());
    network_.first[0] = 0;
    for (std::size_t p = 0; p < n; ++p)
      network_.first[p + 1] =
          network_.first[p] +
          static_cast<std::int64_t>(partners(static_cast<std::int64_t>(p)).size());
    network_.resize(network_.first[n]);
    outside_.assign((n + rows_per_block - 1) / rows_per_block, 0);
    parallel_ranges(list_.rows(), rows_per_block, [&](std::int64_t begin, std::int64_t end) {
      Differences<D> pairs;
      auto done = index(network_.first[index(begin)]);
      int& outside = outside_[index(begin / rows_per_block)];
      for (std::int64_t p = begin; p < end; ++p)
        for (const std::int32_t q : partners(p)) {
          const std::size_t k = done + pairs.size;
          network_.i[k] = static_cast<std::int32_t>(p);
          network_.j[k] = q;
          pairs.add(positions_[index(p)], positions_[index(q)]);
          if (pairs.size == block) outside += flush(pairs, done);
        }
      if (pairs.size > 0) outside += flush(pairs, done);
    });
    return std::all_of(outside_.begin(), outside_.end(), [](int count) { return count == 0; });
  }

  // Completes the edges from `done` on, and moves it.
  int flush(Differences<D>& pairs, std::size_t& done) {
    pairs.close(kernel_, images_, box_);
    int overlaps = 0;
    const int outside =
        kernel_.directions(D, static_cast<int>(pairs.size), pairs.column, pairs.square, reach2_,
                           network_.e[done].x.data(), &network_.r[done], &overlaps);
    const std::size_t end = done + pairs.size;
    for (std::size_t k = done; overlaps > 0 && k < end; ++k)
      if (network_.r[k] == 0.0)
        network_.e[k] = overlap_direction<D>(particles_.id[index(network_.i[k])],
                                             particles_.id[index(network_.j[k])]);
    fill_(network_, done, end);
    done = end;
    pairs.size = 0;
    return outside;
  }

  const kernels::EdgeKernels& kernel_;
  const PairList<D>& list_;
  kernels::Images images_{};
  double reach2_;
  std::vector<double> reaches2_;  // of each pair of species; empty: reach2_
  std::int64_t species_ = 0;
  std::span<const Vec<D>> positions_;
  const Particles<D>& particles_;
  const Fill& fill_;
  PairNetwork<D>& network_;
  const Box<D>& box_;
  Pairs wanted_;
  std::vector<std::int64_t> candidates_;  // where each row of the list begins
  std::vector<std::int32_t> contacts_;    // pairs of each row that are edges
  std::vector<int> outside_;
};

}  // namespace

template <int D>
void write_edge_geometry(const PairList<D>& list, double cutoff, const Box<D>& box,
                         std::span<const Vec<D>> positions, const Particles<D>& particles,
                         const std::function<void(PairNetwork<D>&, std::size_t, std::size_t)>& fill,
                         PairNetwork<D>& network, std::span<const double> reaches) {
  Writer<D>(list, cutoff, box, positions, particles, fill, network, Pairs::moving, reaches).write();
}

template <int D>
void write_rigid_geometry(const PairList<D>& list, double cutoff, const Box<D>& box,
                          std::span<const Vec<D>> positions, const Particles<D>& particles,
                          PairNetwork<D>& network) {
  const typename Writer<D>::Fill nothing = [](PairNetwork<D>&, std::size_t, std::size_t) {};
  Writer<D>(list, cutoff, box, positions, particles, nothing, network, Pairs::rigid, {}).write();
}

#define ODPD_INSTANTIATE(D)                                                                    \
  template void write_edge_geometry<D>(                                                        \
      const PairList<D>&, double, const Box<D>&, std::span<const Vec<D>>, const Particles<D>&, \
      const std::function<void(PairNetwork<D>&, std::size_t, std::size_t)>&, PairNetwork<D>&,  \
      std::span<const double>);                                                                \
  template void write_rigid_geometry<D>(const PairList<D>&, double, const Box<D>&,             \
                                        std::span<const Vec<D>>, const Particles<D>&,          \
                                        PairNetwork<D>&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
