#pragma once
// Energy of one particle among the others (of a constituent: among those outside its body),
//
//   U_i(r) = sum_{j != i, |r - r_j| < r_c} u(|r - r_j|) + U_bonds(r) + V(r)
//
// with u and U_bonds of the pair model and V of the surroundings: what a trial move changes. Particles are kept in
// cells one cutoff wide, updated move by move.
#include <cstdint>
#include <vector>

#include "odpd/dynamics/surroundings.h"
#include "odpd/geometry/pair_list.h"
#include "odpd/pairs/pair_model.h"

namespace odpd {

template <int D>
class LocalEnergy {
 public:
  /// References must outlive this object; the number of particles stays. `place` before use.
  LocalEnergy(const Box<D>& box, const PairModel<D>& model, const Surroundings<D>& surroundings,
              const Particles<D>& particles);

  /// Sorts all particles into their cells; sums come out in an order fixed by positions and memory order from here on.
  void place();
  /// U_i(r) with all others where they were placed or last moved to; r inside the box along periodic directions.
  double at(std::size_t i, const Vec<D>& r);
  /// Particle i went from where it was placed or last moved to r.
  void moved(std::size_t i, const Vec<D>& r);

 private:
  struct Member {
    Vec<D> r;
    std::int32_t index;
  };
  struct Partner {
    double r2;
    std::int32_t index;
  };
  std::span<const Partner> partners_of(const Vec<D>& r);

  const Box<D> box_;
  Vec<D> period_;  // of each direction, infinite where it is bounded
  const PairModel<D>& model_;
  const Surroundings<D>& surroundings_;
  const Particles<D>& particles_;
  const CellList<D> grid_;                         // for its geometry only
  std::vector<std::vector<std::int64_t>> around_;  // of each cell: it and its neighbours
  std::vector<std::vector<Member>> members_;
  std::vector<std::int64_t> cell_;   // of each particle
  std::vector<Partner> candidates_;  // scratch, one entry per particle
};

}  // namespace odpd
