#pragma once
// What a trial move changes. A particle among the others (a constituent: among those outside its body) has the energy
//
//   U_i(r) = sum_{j != i, |r - r_j| < r_c} u(|r - r_j|) + U_bonds(r) + V(r)
//
// with u and U_bonds of the pair model and V of the surroundings. In a model with densities (pairs/densities.h) a move also changes
// psi(d_j) of those near its start or its end, so d_j of every particle is kept along. Particles are kept in cells one cutoff
// wide, updated move by move.
#include <cstdint>
#include <vector>

#include "odpd/dynamics/surroundings.h"
#include "odpd/geometry/pair_list.h"
#include "odpd/pairs/pair_model.h"

namespace odpd {

template <int D>
class LocalEnergy {
 public:
  /// References must outlive this object; the number of particles stays. `sort_in` before use.
  LocalEnergy(const Box<D>& box, const PairModel<D>& model, const Surroundings<D>& surroundings,
              const Particles<D>& particles);

  /// Sorts all particles into their cells and sums their densities. Sums come out in an order fixed by positions and memory
  /// order from here on.
  void sort_in();
  /// Energy change when `moved` go to these positions (inside the box along periodic directions): one particle, or constituents
  /// of one body, which stay as far from each other as they are. Throws ConfigError for others.
  double change(std::span<const std::int32_t> moved, std::span<const Vec<D>> to);
  /// The last change comes about; the caller moves the particles.
  void accept();

 private:
  struct Member {
    Vec<D> r;
    std::int32_t index;
  };
  struct Partner {
    double r2;
    std::int32_t index;
  };
  struct Density {
    double d, psi;
  };
  struct NewDensity {
    std::int32_t index;
    double d;
    double psi;
  };
  std::span<const Partner> partners_of(const Vec<D>& r);
  bool meet(std::size_t i, std::size_t j) const;
  double at(std::size_t i, const Vec<D>& r, double sign);
  void sum_densities();
  void weigh(std::size_t i, std::span<const Partner> partners, double sign);
  double& new_density(std::size_t i);
  double density_change();
  void move(std::size_t i, const Vec<D>& r);

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
  std::vector<std::int32_t> moved_;  // of the last change, and where to
  std::vector<Vec<D>> to_;
  // With densities only.
  const Densities* densities_;
  std::vector<Density> density_;    // of each particle
  std::vector<NewDensity> new_;     // of those that the last change concerns
  std::vector<std::int32_t> slot_;  // of each particle in `new_`, -1 where it is not there
};

}  // namespace odpd
