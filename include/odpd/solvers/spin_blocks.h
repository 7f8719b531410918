#pragma once
// The blocks of all unknowns of a particle that spins, in the local part of the preconditioner: D of its velocity and spin
// together,
//
//   D = ( D_vv  D_vw )    D_vw = -sum over its edges  l/R zeta_perp X(e),   X(e) w = w x e
//       ( D_wv  D_ww )
//
// Each edge touches two such blocks, so that 2 D - A = sum_edges of Z on (J_i q_i - J_j q_j) >= 0 and the eigenvalues of D^-1 A
// are at most 2, as without spins. (Of velocity and spin apart they are up to 4, beside a particle with all neighbours on one
// side, where D_vw does not cancel.) The diagonal blocks of D^-1 are the caller's; here is what couples the two.
#include <cstdint>
#include <vector>

#include "odpd/operator/spin_rows.h"

namespace odpd {

template <int D>
class SpinBlocks {
 public:
  using Block = typename Resistance<D>::Block;
  static constexpr std::size_t freedoms = 2 * D;

  /// Calls keep(place, block) with the diagonal blocks of D^-1 at the places of velocity and spin, NaN where D is singular.
  template <class Keep>
  void pack(const SpinResistance<D>& resistance, const SlicedRows<D>& rows, const Keep& keep);
  void clear() { places_.clear(); }
  bool empty() const { return places_.empty(); }

  // Vectors of velocities, then spins (operator/spin_rows.h).

  /// z += what couples velocity and spin in D^-1 r; returns its part of r . z.
  double couple(const float* r, float* z);
  /// Keeps that of v for `subtract`.
  void gather(const float* v);
  /// v -= step times what was gathered.
  void subtract(float step, float* v) const;
  std::int64_t bytes() const;

 private:
  using Whole = typename SpinResistance<D>::ParticleBlock;
  using Pair = std::array<float, freedoms>;
  static Whole inverse(const SpinResistance<D>& resistance, std::size_t row);
  void resize(std::int64_t spins, std::int64_t first_place);
  Pair product(std::size_t spin, const float* v) const;
  void add(float factor, const Pair& pair, std::size_t spin, float* v) const;

  std::int64_t first_place_ = 0;                          // of spins
  std::vector<std::int32_t> places_;                      // of velocities, per spin
  std::vector<std::array<float, index(D* D)>> coupling_;  // (D^-1)_vw
  std::vector<Pair> gathered_;
  std::vector<double> sums_;
};

template <int D>
template <class Keep>
void SpinBlocks<D>::pack(const SpinResistance<D>& resistance, const SlicedRows<D>& rows,
                         const Keep& keep) {
  resize(resistance.spins(), rows.places());
  parallel_for(rows.places(), [&](std::int64_t place) {
    const std::int32_t row = rows.node_of_place()[index(place)];
    const std::int32_t spin = row < 0 ? -1 : resistance.spin_of(index(row));
    if (spin < 0) return;
    const Whole all = inverse(resistance, index(row));
    Block velocity, own;
    for (std::size_t r = 0; r < D; ++r)
      for (std::size_t c = 0; c < D; ++c) {
        velocity[r * D + c] = all[r * freedoms + c];
        own[r * D + c] = all[(D + r) * freedoms + D + c];
        coupling_[index(spin)][r * D + c] = static_cast<float>(all[r * freedoms + D + c]);
      }
    places_[index(spin)] = static_cast<std::int32_t>(place);
    keep(place, velocity);
    keep(first_place_ + spin, own);
  });
}

}  // namespace odpd
