#pragma once
// Geometric multigrid for a 3^D stencil of D x D blocks: one V-cycle approximates the inverse of the grid operator.
//
//   smoothing  Chebyshev polynomials of degree 2 in D^-1 A on the upper part of its spectrum, before and after
//   coarsening P^T A P with multilinear P (the stencil stays 3^D), every even direction halved
//   coarsest   a dense inverse; translations, where they are null there, are left out
//
// The cycle is symmetric and positive definite, as conjugate gradients need it.
#include <cstdint>
#include <vector>

#include "odpd/operator/sliced_rows.h"
#include "odpd/solvers/grid_shape.h"

namespace odpd {

/// A on a grid.
template <int D>
class GridOperator {
 public:
  explicit GridOperator(const GridShape<D>& shape);
  const GridShape<D>& shape() const { return shape_; }
  /// Upper triangle of the block that couples point number `n` with its neighbour `entry`, 16 floats apart.
  float* block(std::int64_t n, int entry);
  const float* block(std::int64_t n, int entry) const;
  /// To be called once the blocks are filled. Points without friction stay out of everything.
  void set_up_smoother();
  /// P^T A P on the coarser grid.
  GridOperator coarsened() const;
  std::int64_t bytes() const;

  // Grid vectors (shape().pitch() * D floats each): b of the points, zero elsewhere.
  void smooth_from_zero(const float* b, float* x, float* direction, float* work) const;
  void smooth(const float* b, float* x, float* direction, float* work) const;
  void residual(const float* b, float* x, float* r) const;
  /// Copies the points at the ends of periodic directions to the ghosts of the other end.
  void fill_ghosts(float* x) const;

  const FloatArray& blocks() const { return blocks_; }
  FloatArray& blocks() { return blocks_; }

 private:
  struct Step {
    float keep, step;
  };
  /// direction = keep direction + step D^-1 (b - A x), y = x + direction.
  void relax(const float* x, const float* b, float* direction, float* y, const Step& step) const;
  double largest_eigenvalue() const;
  float* first(float* vector) const { return vector + shape_.margin(); }
  const float* first(const float* vector) const { return vector + shape_.margin(); }

  GridShape<D> shape_;
  FloatArray blocks_, inverse_;
  Step steps_[2] = {};
};

template <int D>
class Multigrid {
 public:
  /// `null_translations`: A E = 0 for the translations E, on this and so on every coarser grid.
  void set_up(GridOperator<D> finest, bool null_translations);
  bool empty() const { return levels_.empty(); }
  bool null_translations() const { return null_translations_; }
  const GridOperator<D>& finest() const { return levels_.front().a; }

  /// Right-hand side and answer of a cycle, grid vectors of the finest grid.
  float* b() { return levels_.front().b.data() + finest().shape().margin(); }
  const float* x() const { return levels_.front().x.data() + finest().shape().margin(); }
  /// x = V b; the ghosts of x are filled.
  void cycle();
  std::int64_t bytes() const;

 private:
  struct Level {
    explicit Level(GridOperator<D> a);
    GridOperator<D> a;
    FloatArray b, x, r, direction, work;
  };
  void set_up_dense();
  void solve_dense();
  void cycle(std::size_t level);
  void restrict_residual(std::size_t level);
  void add_correction(std::size_t level);

  bool null_translations_ = false;
  std::vector<Level> levels_;
  std::vector<std::int64_t> dense_points_;
  FloatArray dense_inverse_, dense_b_, dense_x_;
};

}  // namespace odpd
