#pragma once
// Block-Jacobi for solvers in double on any System: z = D^-1 r, D the block diagonal of A.
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/operator/system.h"

namespace odpd {

/// Throws SolverError naming the first node whose diagonal block is not positive definite.
void require_definite_diagonal(const System& system);
/// Throws that error for this node.
[[noreturn]] void reject_block(std::int64_t node);

/// Replaces a symmetric b x b block (row-major) by its inverse; false, and the block spoilt, when
/// it is not positive definite to rounding.
bool invert_definite(std::span<double> block, int b);

class BlockJacobi {
 public:
  void set_up(const System& system);
  /// z = D^-1 r; the same bits on any thread count.
  void apply(std::span<const double> r, std::span<double> z) const;
  std::int64_t memory_bytes() const;

 private:
  int block_ = 1;
  std::vector<double> inverse_;  // nodes * b * b
};

}  // namespace odpd
