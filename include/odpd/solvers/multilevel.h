#pragma once
// The multilevel preconditioner of conjugate gradients on the rows of R:
//
//   z = q(D^-1 A) D^-1 r + P V P^T r,   q(L) = 2 (2.15 - L), or, where few neighbours share a particle's friction,
//                                       q(L) = 2 (1 - T_4(x)/T_4(x_0))/L,  x = (2.1 - 2 L)/1.9, x_0 = 2.1/1.9
//
// D the block diagonal (of a rigid body all of its unknowns), P multilinear interpolation from a regular grid of about 1.7
// cutoffs to the particles, V a multigrid cycle for the Galerkin operator of the grid. The eigenvalues of D^-1 A are at most
// 2, since
//
//   2 D - A = sum_edges g g^T on v_i + v_j (and what holds a node) >= 0,
//
// so the local part, two or four steps of block-Jacobi, is definite. (T_4: Chebyshev's polynomial, small for 0.1 < L < 2.) With
// rigid bodies the caller projects what P gives on the velocities in which these are rigid.
// Of a particle that spins D has all unknowns, too (solvers/spin_blocks.h), and P gives its spin w = 1/2 curl v of the grid, P^T
// its torque's share. Places of spins follow those of velocities (operator/spin_rows.h).
// It serves clusters of strongly bound particles that move together against weak ties: D alone takes them to be as stiff as
// the ties inside. The grid stands still while the particles move, so its operator ages slowly: it is kept until convergence
// has slowed down (`note_rate`).
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/core/archive.h"
#include "odpd/operator/spin_rows.h"
#include "odpd/solvers/multigrid.h"

namespace odpd {

/// Where a chunk of the places begins: a multiple of 1024, the block of sums.
std::int64_t chunk_begin(std::int64_t places, std::int64_t chunk);

/// q(L) D^-1 r with q(L) = c_0 - L (c_1 - L (c_2 - ...)), L = D^-1 A.
using LocalPart = std::vector<double>;

template <int D>
class Multilevel {
 public:
  /// Positions in the grid, and the grid's operator where it is missing, belongs to another shift or stiffness, or has
  /// aged. Rebuilding costs about as much as one solve to 1e-7.
  /// `rigid`: the operator around `resistance` where there are rigid bodies, else null. `spins`: that around both, null where
  /// nobody spins.
  void set_up(const Resistance<D>& resistance, const SlicedRows<D>& rows,
              const RigidResistance<D>* rigid = nullptr, const SpinResistance<D>* spins = nullptr);
  /// Decades of residual per iteration of the last solve. Below `aged` times those of the first solve with the present
  /// grid operator, the next set-up builds it anew.
  void note_rate(double decades_per_iteration);
  static constexpr double aged = 0.8;
  /// false: rates are not noted and no grid ages.
  void remember(bool on) { remembers_ = on; }

  /// The local part, which is the caller's.
  LocalPart local() const;

  // One application, piece by piece, so that the loops over the particles can be joined with others.
  /// The pieces [0, chunks()) of the places may be restricted at the same time.
  static constexpr std::int64_t chunks() { return 16; }
  void clear_chunk(std::int64_t chunk);
  /// P^T r of places [first, last) of a chunk.
  void restrict_chunk(std::int64_t chunk, const float* r, std::int64_t first, std::int64_t last);
  /// e = V P^T r; returns (P^T r) . e.
  double cycle();
  /// p = z + P e + beta p for places [first, last).
  void interpolate(const float* z, float* p, float beta, std::int64_t first,
                   std::int64_t last) const;

  std::int64_t builds() const { return builds_; }
  std::int64_t bytes() const;
  void save(StateWriter& out) const;
  void load(const StateReader& in);

 private:
  void build(const Resistance<D>& resistance, const RigidResistance<D>* rigid,
             const SpinResistance<D>* spins);
  void place_nodes(const Resistance<D>& resistance, const SlicedRows<D>& rows,
                   const SpinResistance<D>* spins);

  const Communicator* ranks_ = &Communicator::alone();  // each of which has the whole grid
  Multigrid<D> grid_;
  double shift_ = 0.0, stiffness_time_ = 0.0;  // what the grid operator was built with
  double fresh_rate_ = 0.0, last_rate_ = 0.0;
  bool remembers_ = true;
  double ties_ = 0.0;  // of FrictionSpread, when the operator was built
  std::int64_t builds_ = 0;
  std::int64_t places_ = 0, velocities_ = 0;  // all, and those of velocities
  FloatArray half_length_;                    // R/2 of the spins' places, 0 at empty ones
  std::array<float, 4 * D> slopes_{};         // grid_slopes
  FloatArray place_;                          // position in cell and cell, four floats per place
  FloatArray restricted_;                     // per chunk a grid vector, point by point
  FloatArray correction_;                     // e, point by point
  std::vector<std::int64_t> touched_begin_;   // per chunk the grid floats that its places touch
  std::vector<std::int64_t> touched_end_;
};

}  // namespace odpd
