#pragma once
// Rigid bodies among the packed rows of R (operator/sliced_rows.h): conjugate gradients run on velocities of particles,
// with the projector on those in which bodies are rigid,
//
//   Pi = P P^T,   Pi A Pi x = Pi b,   local part of the preconditioner  P D_B^-1 P^T,   D_B = the body's block of P^T A P
//
// P of operator/rigid_map.h, orthonormal. D_B is exact, 2D x 2D: edges inside a body are none, so each edge touches two
// blocks, and the eigenvalues of D^-1 A stay below 2 as without bodies.
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/operator/rigid_resistance.h"
#include "odpd/operator/sliced_rows.h"

namespace odpd {

template <int D>
class PackedBodies {
 public:
  /// A block may be singular, where few edges meet a body: its pseudo-inverse then leaves out what they do not resist.
  void pack(const RigidResistance<D>& resistance, const SlicedRows<D>& rows);
  /// No bodies, until the next pack.
  void clear() { bodies_ = 0; }
  bool empty() const { return bodies_ == 0; }

  // Node vectors of the packed rows. Only the places of constituents are read and written.

  /// v := Pi v.
  void project(float* v);
  /// z := P D_B^-1 P^T r; returns r . z of the constituents.
  double solve(const float* r, float* z);
  /// Keeps P^T v for `subtract`.
  void gather(const float* v);
  /// v -= step P D_B^-1 of what was gathered.
  void subtract(float step, float* v) const;

  /// r := P y / scale, of the unknowns of bodies.
  void scatter(std::span<const double> y, double scale, float* r) const;
  /// y += scale P^T d.
  void add_to(const float* d, double scale, std::span<double> y);

  /// The answer where unknowns move no constituent: x := b there.
  void settle_unused(std::span<const double> b, std::span<double> x) const;

  std::int64_t bytes() const;

 private:
  static constexpr std::size_t freedoms = 2 * D;
  using Motion = std::array<float, freedoms>;  // V, then w

  template <class Change>
  void for_each_body(const Change& change) const;
  /// write(v, u) for the velocity u of each constituent of a body, in its motion `find`(body), and its place v.
  template <class Find, class Write>
  void for_each_constituent(const Find& find, float* v, const Write& write) const;
  /// P^T P times this is what was gathered.
  Motion closest(std::size_t b) const;
  /// D_B^-1 of what was gathered.
  Motion answer(std::size_t b) const;

  const RigidResistance<D>* resistance_ = nullptr;
  std::int64_t bodies_ = 0;
  Share share_;                       // rows
  std::vector<std::int32_t> offset_;  // per constituent: where its place begins in a node vector
  FloatArray arm_;                    // per constituent, as a node vector
  std::vector<std::array<float, 1 + D * D>> inverse_inertia_;          // 1/m, and S^2
  std::vector<std::array<float, freedoms * freedoms>> inverse_block_;  // of V, w from F, T
  std::vector<std::array<double, freedoms>> load_;                     // F, T: what was gathered
  std::vector<double> work_;                                           // r . z of a body
};

}  // namespace odpd
