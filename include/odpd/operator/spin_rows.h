#pragma once
// What spins add to the packed rows of R (operator/sliced_rows.h), in single precision:
//
//   s = e x (a_i y_i + a_j y_j),   u = v_i - v_j,   row i:  f += zeta_perp s,   t += I' y_i - a_i e x zeta_perp (u + s)
//
// with y = R w, a = l/R and I' the inertia on the diagonal (operator/spin_resistance.h). Only particles that spin, or have a
// neighbour that does, have a row here, so the cost is that of edges with levers. Both rows of an edge hold the same e and
// zeta_perp, that of SlicedRows, so that the sum with R is positive semidefinite as J^T Z J is.
//
// Vectors: those of SlicedRows, then a place for each spin, filled up to a multiple of sixteen by places without one, of
// which there is at least one. There vectors are zero; it stands for spins and velocities that are known.
#include <cstdint>
#include <vector>

#include "odpd/operator/sliced_rows.h"
#include "odpd/operator/spin_resistance.h"

namespace odpd {

template <int D>
class SpinRows {
 public:
  /// Places of velocities whose rows are packed together; a product begins and ends at multiples of it.
  static constexpr std::int64_t window = 1024;

  /// Places of so many spins.
  static std::int64_t places_of(std::int64_t spins) { return (spins / 16 + 1) * 16; }

  /// Friction sees the spin of a free body at some constituent. Such spins have no place here.
  static bool bodies_spin(const SpinResistance<D>& resistance);

  void pack(const SpinResistance<D>& resistance, const SlicedRows<D>& rows);
  /// No spins, until the next pack.
  void clear();
  bool empty() const { return places_ == 0; }

  /// Of spins; the first is that behind the places of velocities.
  std::int64_t places() const { return places_; }
  std::int64_t first_place() const { return first_place_; }

  /// y += A x for the rows of the velocities at places [first, last), y = A x for their spins; returns what this adds to x . y.
  double product(const float* x, float* y, std::int64_t first, std::int64_t last) const;
  std::int64_t bytes() const;

 private:
  void sort_window(const SpinResistance<D>& resistance, const SlicedRows<D>& rows,
                   std::int64_t window);
  void fill_slice(const SpinResistance<D>& resistance, const SlicedRows<D>& rows,
                  std::int64_t slice);

  std::int64_t places_ = 0, first_place_ = 0;
  std::vector<std::int64_t> begin_;               // first slice of each window
  std::vector<std::vector<std::int32_t>> order_;  // rows of each window, by falling number of links
  std::vector<std::int32_t> row_;                 // at each lane of the slices, -1: none
  std::vector<std::int64_t> start_;               // first slot of each slice
  FloatArray own_, links_;
};

}  // namespace odpd
