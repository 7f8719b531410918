#pragma once
// Kernels of the multilevel preconditioner and of single-precision conjugate gradients, one table per instruction path.
#include <cstdint>

namespace odpd {

/// A 3^D block stencil on a padded grid (solvers/grid_shape.h). Vectors: one component after the other, `pitch` floats
/// apart, pointers to the first grid point.
struct StencilView {
  const float*
      blocks;  ///< per 16 points, stencil entry, upper triangle of the D x D block: 16 floats
  const float* inverse;  ///< per 16 points, upper triangle of the inverted centre block: 16 floats
  std::int64_t pitch;
  std::int64_t offset[27];  ///< of each stencil entry
};

/// Where the nodes lie in the grid: per place four floats, the position in its cell (0 to 1 in each direction) and, as
/// bits, the offset of the cell's lowest corner in a grid vector stored point by point (node_stride<D> floats each).
struct TransferView {
  const float* place;
  std::int64_t corner[8];  ///< offsets of the cell's corners from the lowest one, x fastest
};

/// Spins at places of the grid: y = length curl v, 1/2 R for w = 1/2 curl v and y = R w, 0 at a place without one. `slope`: row c,
/// four floats, has the derivative along axis c of space from those along the cell's edges, d_c = sum_a slope[4 c + a] d_a.
struct CurlView {
  const float* length;
  const float* slope;
};

/// Matrices of the cells of a grid, and the nodes that are seen from it. An element holds the D x D blocks, as triangles, of
/// the corners n, m of its cell. It is symmetric in n and m: only m = n + s modulo 2^D with s <= 4 is kept, at `element_place`.
struct ElementView {
  const float* position;   ///< per node four floats, in units of the spacing from the first point
  float cells[4];          ///< per direction; 1 in the unused ones
  float wrap[4];           ///< the same in periodic directions, 0 in others
  std::int32_t stride[4];  ///< of the cells' numbers; 0 in the unused ones
  float* elements;
};

/// The friction of edges: per edge D numbers g and, with friction across e (null: none), zeta_perp and the sign of
/// zeta_par - zeta_perp.
struct EdgeView {
  const double* g;
  const double* across;
};

template <int D>
inline constexpr int element_floats = D == 2 ? 3 * 16 : 6 * 40;

/// Of entry (n, m) for the number w in the triangle: lanes n of s = 0, 1, ...
template <int D>
constexpr int element_place(int w, int n, int m) {
  constexpr int corners = 1 << D, triangle = D * (D + 1) / 2;
  int s = (m - n + corners) % corners;
  if (s > 4) {
    s = corners - s;
    n = m;
  }
  return w * (element_floats<D> / triangle) + s * corners + n;
}

struct CgSums {
  double rr, rz;
};

/// [D - 2] in each.
struct MultilevelKernels {
  // On the grid, for the groups of 16 points [first, last).
  /// r = b - A x; ghosts of x filled.
  void (*residual[2])(const StencilView&, const float* x, const float* b, float* r,
                      std::int64_t first, std::int64_t last);
  /// d = keep d + step D^-1 (b - A x), y = x + d.
  void (*relax[2])(const StencilView&, const float* x, const float* b, float* d, float* y,
                   float keep, float step, std::int64_t first, std::int64_t last);
  /// d = step D^-1 b, x = d.
  void (*relax_zero[2])(const StencilView&, const float* b, float* d, float* x, float step,
                        std::int64_t first, std::int64_t last);
  /// grid += P^T r over the places [first, last).
  void (*restrict_to[2])(const TransferView&, const float* r, float* grid, std::int64_t first,
                         std::int64_t last);
  /// p = z + P grid + beta p.
  void (*interpolate[2])(const TransferView&, const float* grid, const float* z, float* p,
                         float beta, std::int64_t first, std::int64_t last);
  /// The same two for spins.
  void (*restrict_curl[2])(const TransferView&, const CurlView&, const float* r, float* grid,
                           std::int64_t first, std::int64_t last);
  void (*interpolate_curl[2])(const TransferView&, const CurlView&, const float* grid,
                              const float* z, float* p, float beta, std::int64_t first,
                              std::int64_t last);
  /// x += alpha p, r -= alpha q, z = D^-1 r; D^-1 as upper triangles, 16 floats each.
  CgSums (*update[2])(const float* inverse, float alpha, const float* p, const float* q, float* x,
                      float* r, float* z, std::int64_t first, std::int64_t last);
  /// w = keep y - step D^-1 w; returns y . w, with w as it was.
  double (*local[2])(const float* inverse, float keep, float step, const float* y, float* w,
                     std::int64_t first, std::int64_t last);
  /// Adds to the element of the node's cell, with the gradients of N at the node,
  /// half of sum_links (d . grad N_n) (d . grad N_m) W, d = r - r_other in units of the spacing, and N_n N_m `anchor`
  /// (a triangle; null: none). `link`: per link its edge and its other node. `inside`, times `stiffness`: more of the
  /// sums of d_a d_b W, a triangle of triangles (null: none).
  void (*add_node[2])(const ElementView&, const EdgeView&, std::int64_t node,
                      const std::int32_t* link, std::int64_t links, const float* anchor,
                      const float* inside, float stiffness);
  void (*dense)(const float* matrix, std::int64_t size, const float* x, float* y);
};

extern const MultilevelKernels multilevel_portable;
extern const MultilevelKernels multilevel_avx2;
extern const MultilevelKernels multilevel_avx512;

/// The table of the process's path.
const MultilevelKernels& multilevel_kernels();

}  // namespace odpd
