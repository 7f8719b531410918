#pragma once
// Backends that work on the assembled matrix and know nothing of a held centre of mass. The
// constraint is met by the Schur complement, with E the translations that the system names:
//
//   Pi A x = Pi b, E^T x = 0   <=>   x = y - Z (E^T Z)^-1 E^T y,   A y = b,   A Z = E
//
// Nor of null motions that are no translations. Where there are any, the backend gets a regular matrix with a spring at one
// unknown p per null motion. A load in the range of A does not stretch these springs:
//
//   A x = b   <=>   x = Pi y,   (A + sum_p A_pp e_p e_p^T) y = b
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/solvers/solver.h"

namespace odpd {

class AssembledSolver : public Solver {
 protected:
  using Solver::Solver;

  /// Copies `a` to the backend and prepares it. Adds the seconds of the
  /// copy to assembly_seconds_.
  virtual void set_up_matrix(const BlockCsr& a) = 0;
  /// Solves A x = b without the constraint (b is projected where translations are null).
  virtual Attempt attempt_free(std::span<const double> b, std::span<double> x,
                               double tolerance) = 0;
  /// Bytes of the backend itself; the assembled matrix of the system comes on top.
  virtual std::int64_t backend_bytes() const = 0;

  /// The matrix that the backend has is singular: A E = 0.
  bool null_translations_ = false;

 private:
  void set_up() final;
  Attempt attempt(std::span<const double> b, std::span<double> x, double tolerance) final;
  std::int64_t memory_bytes() const final;
  BlockCsr with_springs(const BlockCsr& a) const;
  Attempt find_response(double tolerance);
  void hold_centre(std::span<double> x) const;

  std::vector<std::vector<double>>
      response_;                       // the columns of Z, made in the first solve after a bind
  std::vector<double> inverse_schur_;  // (E^T Z)^-1, row-major
};

}  // namespace odpd
