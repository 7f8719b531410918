#pragma once
// The two ways `pcg` works: in double on any System, and in single precision with refinement on the rows of R.
#include <memory>
#include <string>

#include "odpd/core/archive.h"
#include "odpd/operator/free_motions.h"
#include "odpd/solvers/solver.h"

namespace odpd {

class CgEngine {
 public:
  virtual ~CgEngine() = default;
  /// It can be set up with this system.
  virtual bool serves(const System& system) const = 0;
  virtual void set_up(const System& system) = 0;
  /// As Solver::attempt, in at most `most_iterations` iterations.
  /// A failure, unless these did not suffice, leaves x as it was.
  virtual Solver::Attempt attempt(std::span<const double> b, std::span<double> x, double tolerance,
                                  std::int64_t most_iterations) = 0;
  virtual std::int64_t memory_bytes() const = 0;
  /// What a report should say besides (a fallback); empty: nothing.
  virtual std::string note() const { return {}; }
  virtual void save(StateWriter&) const {}
  virtual void load(const StateReader&) {}
  virtual void remember(bool /*on*/) {}
};

/// Null unless the system is a Resistance, or a RigidResistance or SpinResistance around one (of the latter without spins of bodies).
std::unique_ptr<CgEngine> make_mixed_cg(const System& system, const SolverOptions& options);

/// Residuals of conjugate gradients rise and fall, but never by this much on a regular system.
inline constexpr double divergence = 1e6;
inline const std::string diverged =
    std::string(
        "the residual grows without bound: the matrix is singular, as where some particles "
        "can move against others without friction, and the forces do work on that motion; "
        "what helps is ") +
    drag_cure + ", or mass (fluid.mass)";
inline constexpr const char* no_longer_finite = "numbers are no longer finite";

}  // namespace odpd
