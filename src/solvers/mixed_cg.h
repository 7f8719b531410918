#pragma once
// Conjugate gradients on the packed rows of R (operator/sliced_rows.h) in single precision, for the correction d of
//
//   A d = r,   r = Pi (b - A x) in double,   x := x + d
//
// Where the recursive residual has fallen far below that of the last double one, x and r are brought up to date in double
// and the iteration goes on with its search direction (reliable updates; Clark et al. 2010). On a held system Pi is
// applied to p and A p. With rigid bodies d, r, p are velocities and forces of particles, and another projection keeps bodies
// rigid (solvers/packed_bodies.h). Single precision holds out up to condition numbers of some 1e7; beyond, the attempt
// gives up.
#include <string>
#include <vector>

#include "cg_engine.h"
#include "multilevel_kernels.h"
#include "odpd/core/index.h"
#include "odpd/solvers/multilevel.h"
#include "odpd/solvers/packed_bodies.h"
#include "odpd/solvers/spin_blocks.h"

namespace odpd {

template <int D>
class MixedCg : public CgEngine {
 public:
  explicit MixedCg(const SolverOptions& options) : preconditioner_(options.preconditioner) {}

  bool serves(const System& system) const override {
    if (const auto* spins = dynamic_cast<const SpinResistance<D>*>(&system))
      return !SpinRows<D>::bodies_spin(*spins);
    return dynamic_cast<const Resistance<D>*>(&system) != nullptr ||
           dynamic_cast<const RigidResistance<D>*>(&system) != nullptr;
  }
  void set_up(const System& system) override;
  Solver::Attempt attempt(std::span<const double> b, std::span<double> x, double tolerance,
                          std::int64_t most_iterations) override;
  std::int64_t memory_bytes() const override;
  std::string note() const override { return note_; }
  void save(StateWriter& out) const override { grid_.save(out); }
  void load(const StateReader& in) override { grid_.load(in); }
  void remember(bool on) override { grid_.remember(on); }

 private:
  static constexpr std::int64_t slice_places = 16;
  static constexpr std::int64_t block_places = 1024;  // of sums, whatever the threads
  static constexpr std::int64_t stride = SlicedRows<D>::stride;
  static constexpr std::int64_t triangle = D * (D + 1) / 2;
  enum class Outcome { reached, gave_up, out_of_iterations };

  bool is_constituent(std::int32_t row) const {
    return rigid_ != nullptr && rigid_->is_constituent(index(row));
  }
  /// Node of the system whose unknowns a place holds, -1 for none of its own.
  std::int32_t unknown_of(std::int64_t place) const {
    if (place >= rows_.places()) {
      const std::int64_t spin = place - rows_.places();
      return spin < in_front_ ? static_cast<std::int32_t>(spin) : -1;
    }
    const std::int32_t row = rows_.node_of_place()[index(place)];
    const std::int32_t node = rigid_ == nullptr || row < 0 ? row : rigid_->node_of(index(row));
    return node < 0 ? -1 : node + static_cast<std::int32_t>(in_front_);
  }
  bool grid_pays() const;
  void invert_diagonal();
  void set_inverse(std::int64_t place, const typename Resistance<D>::Block& inverse);
  double true_residual(std::span<const double> b, std::span<const double> x);
  void load_residual(double scale);
  void flush(std::span<double> x, double scale);
  double multiply(const FloatArray& in, FloatArray& out, std::int64_t block);
  double product();
  CgSums update(double alpha);
  double local_step(double keep, double step, const FloatArray& in, FloatArray& out);
  double precondition(double rz);
  void turn(double beta);
  void project(FloatArray& v);
  Outcome iterate(std::span<const double> b, std::span<double> x, double goal,
                  std::int64_t most_iterations, Solver::Attempt& result);
  /// Of velocities, then of spins.
  std::int64_t places() const { return rows_.places() + spin_rows_.places(); }
  std::int64_t blocks() const { return (places() + block_places - 1) / block_places; }
  /// A block's part in sums is that of the rank that owns its first node: places are sorted within blocks only.
  /// Those of spins alone are the first rank's.
  bool owns(std::int64_t block) const {
    const std::int64_t first = block * block_places;
    return first < rows_.places() ? share_.owns(first) : share_.ranks->rank() == 0;
  }
  double sum_of_blocks();
  std::int64_t end_of(std::int64_t block) const {
    return std::min(places(), (block + 1) * block_places);
  }

  std::string preconditioner_;
  const System* system_ = nullptr;
  const Resistance<D>* resistance_ = nullptr;  // R on the particles that move
  const RigidResistance<D>* rigid_ = nullptr;  // null without bodies
  const SpinResistance<D>* spins_ = nullptr;   // null where nobody spins
  std::int64_t in_front_ = 0;                  // nodes of spins
  Share share_;                                // nodes of R
  SlicedRows<D> rows_;
  SpinRows<D> spin_rows_;
  SpinBlocks<D> spin_blocks_;
  PackedBodies<D> bodies_;
  Multilevel<D> grid_;
  bool with_grid_ = false;
  std::string note_;
  FloatArray inverse_;  // of the diagonal blocks: upper triangles, 16 places side by side
  FloatArray r_, z_, p_, q_, x_;
  FloatArray t_;  // of a third and fourth local step
  LocalPart local_;
  std::vector<double> residual_;
  double first_residual_ = 0.0;  // its norm at the start of an attempt
  std::vector<double> guess_;    // of the attempt at hand, for whoever starts over
  std::vector<double> sums_;     // two per block
};

}  // namespace odpd
