#pragma once
// Preconditioners of the native solvers: z = M^-1 r with M symmetric positive definite.
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/operator/system.h"

namespace odpd {

/// Throws SolverError naming the first node whose diagonal block is not positive definite.
void require_definite_diagonal(const System& system);

/// Replaces a symmetric b x b block (row-major) by its inverse; false, and the block spoilt, when
/// it is not positive definite to rounding.
bool invert_definite(std::span<double> block, int b);

class Preconditioner {
 public:
  virtual ~Preconditioner() = default;
  virtual void set_up(const System& system) = 0;
  /// z = M^-1 r; the same bits on any thread count.
  virtual void apply(std::span<const double> r, std::span<double> z) const = 0;
  virtual std::int64_t memory_bytes() const = 0;
};

/// M = D, the block diagonal of A.
class BlockJacobi : public Preconditioner {
 public:
  void set_up(const System& system) override;
  void apply(std::span<const double> r, std::span<double> z) const override;
  std::int64_t memory_bytes() const override;

 private:
  int block_ = 1;
  std::vector<double> inverse_;  // nodes * b * b
};

}  // namespace odpd
