#pragma once
// Kernels of SlicedRows, one table per instruction path.
#include <cstdint>

namespace odpd {

/// Rows packed in slices of sixteen. Links of a slice, slot by slot: 16 offsets of the neighbours in the node vector
/// (int32, in the place of floats), 16 values per component of g, and with friction across e 16 of zeta_perp, whose sign
/// bit is that of zeta_par - zeta_perp.
struct SlicedView {
  const std::int64_t* start;  ///< first slot of each slice, slices + 1
  const float* links;
  const float*
      anchor;  ///< per slice D (D + 1)/2 times 16, the upper triangle row by row; null: none
};

/// Rows of what spins add (operator/spin_rows.h). Of a slice: 16 offsets of velocities, of spins, 16 inertias. Links, slot by
/// slot: 16 offsets of the neighbours' velocities and of their spins, 16 values per component of e, of zeta_perp, a_i, a_j.
struct SpinView {
  const std::int64_t* start;  ///< first slot of each slice, slices + 1
  const float* own;
  const float* links;
  std::int64_t nothing;  ///< offset of zeros, to be left alone
};

struct SlicedKernels {
  /// y = A x for the slices [first, last); returns x . y of these rows.
  double (*product[2])(const SlicedView&, const float* x, float* y, std::int64_t first,
                       std::int64_t last);  ///< [D - 2]
  double (*product_across[2])(const SlicedView&, const float* x, float* y, std::int64_t first,
                              std::int64_t last);
  /// y += A x of velocities and y = A x of spins in the slices [first, last); returns what this adds to x . y.
  double (*spin_product[2])(const SpinView&, const float* x, float* y, std::int64_t first,
                            std::int64_t last);
};

extern const SlicedKernels sliced_portable;
extern const SlicedKernels sliced_avx2;
extern const SlicedKernels sliced_avx512;

}  // namespace odpd
