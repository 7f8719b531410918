#pragma once
// Kernels of the edges, one table per instruction path. Buffers (those not said to be columns) hold a multiple of 8 entries,
// so that the last vector may be computed whole.
#include <cstdint>

#include "odpd/pairs/weight_columns.h"

namespace odpd::kernels {

/// Directions of the box: differences above half a length are those of another image.
struct Images {
  double length[3], half[3];  ///< half is infinite along a bounded direction
};

/// One pair of species, exponents 1/2, 1 or 2 (pairs/dpd.h).
struct DpdKernelParameters {
  double a, s_bar, gamma, gamma_perp, s, cutoff, gamma_far, cutoff_far;
};

/// Columns of a network at the first edge of a block. u, k_c and zeta_perp may be null: not wanted.
struct DpdColumns {
  double *u, *f_c, *k_c, *zeta_par, *zeta_perp;
};

/// W(r) of a density sum: the shapes of SmoothingKernel in their order, and s (1 - q)^2.
enum class WeightShape { wendland_c2, wendland_c4, lucy, quintic, square };
struct WeightParameters {
  WeightShape shape;
  double scale, support;  ///< s, h
};

struct EdgeKernels {
  /// Differences d[c][k] of positions become those of nearest images, square[k] their squared lengths.
  void (*separations)(int dimensions, const Images& images, int n, double* const* d,
                      double* square);
  /// Columns: e[dimensions k + c] = d[c][k]/r[k], r[k] = sqrt(square[k]). Returns how many squares are not below reach2, and in
  /// `overlaps` how many are 0 (their e is not a number).
  int (*directions)(int dimensions, int n, const double* const* d, const double* square,
                    double reach2, double* e, double* r, int* overlaps);
  void (*dpd)(const DpdKernelParameters& parameters, int n, const double* r,
              const DpdColumns& columns);
  void (*weights)(const WeightParameters& parameters, int n, const double* r,
                  const WeightColumns& columns);
  /// force[dimensions k + c] = sqrt(strength zeta[k]) w[k] e[dimensions k + c]; w is a buffer, the others are columns.
  void (*noise)(int dimensions, double strength, int n, const double* zeta, const double* w,
                const double* e, double* force);
};

extern const EdgeKernels edge_portable, edge_avx2, edge_avx512;

/// Entries of the buffers that callers use.
constexpr int edge_block = 256;

}  // namespace odpd::kernels
