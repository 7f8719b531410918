#pragma once
// Solvers of A x = b (operator/system.h) behind one interface, made by name.
//
//   picard           x := x + D^-1 (b - A x), D diagonal blocks (Phan-Thien et al. 2016, eq. 24)
//   picard-deflated  x := x + D^-1 Pi (b - A x) - E E^T x, Scheme 2  (ibid., eq. 41-46)
//   pcg              conjugate gradients on the rank-1 operator in mixed precision, with multilevel or block-Jacobi
//   eigen-cg         Eigen::ConjugateGradient on the assembled matrix
//   cholmod          SuiteSparse sparse Cholesky
//   petsc            PETSc KSP, any KSP and PC through PETSc options
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "odpd/core/archive.h"
#include "odpd/operator/system.h"

namespace odpd {

/// When an iteration stops.
enum class Stopping {
  residual,   ///< |Pi (b - A x)| <= tolerance |Pi b|, the true residual (the default)
  increment,  ///< |x_l - x_{l-1}| < tolerance |x_l|, Picard only: lax (ibid., eq. 27)
};

struct SolverOptions {
  std::string name = "pcg";
  double tolerance = 1e-5;  ///< relative, see Stopping
  std::int64_t max_iterations = 100000;
  Stopping stopping = Stopping::residual;
  std::string petsc_options = {};  ///< "-ksp_type cg -pc_type icc", without a prefix
  /// Of pcg: "multilevel", "block-jacobi", or "auto" (docs/solvers.md).
  std::string preconditioner = "auto";
};

struct SolveReport {
  bool converged = false;
  std::int64_t iterations = 0;
  double residual = 0.0;          ///< the true relative residual of the returned x
  double setup_seconds = 0.0;     ///< of the last bind
  double assembly_seconds = 0.0;  ///< part of it: System::matrix and copying it to the backend
  double solve_seconds = 0.0;
  /// Matrices, factors and work vectors of the backend (its own estimate).
  std::int64_t memory_bytes = 0;
  /// "R v = f", "R v = f, null space removed", or "centre of mass held still".
  std::string problem;
  std::string failure;  ///< why it did not converge, with the remedy; empty when it did
  std::string note;     ///< what else is worth knowing, e.g. a preconditioner that was given up
};

class Solver {
 public:
  virtual ~Solver() = default;
  const std::string& name() const { return options_.name; }

  /// Set-up for `system`, which must outlive the following solves. Call again when its generation
  /// changed. All ranks of the system's share call `bind` and `solve` together, and get the same report.
  void bind(const System& system);
  /// Solves from the initial guess in x (size system.size()). Never throws for lack of convergence:
  /// the report says so and the caller must act on it. x has zero mean where the problem is
  /// projected. tolerance: of this solve alone; 0: that of the options.
  SolveReport solve(std::span<const double> b, std::span<double> x, double tolerance = 0.0);

  /// What a solver remembers from one solve to the next; a restarted run continues with it.
  virtual void save(StateWriter&) const {}
  /// `system`: of the kind that will be bound.
  virtual void load(const StateReader&, const System& /*system*/) {}

  /// false: until told otherwise, what it remembers stays as it is, so that solves beside those of a run change none of these.
  virtual void remember(bool /*on*/) {}

  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  struct Attempt {
    bool ok = false;
    std::int64_t iterations = 0;
    std::string failure;  ///< empty with ok = false: the iterations ran out
  };

 protected:
  explicit Solver(SolverOptions options) : options_(std::move(options)) {}

  /// Backend set-up for *system_; throws SolverError when A cannot be set up (e.g. a singular
  /// block).
  virtual void set_up() = 0;
  /// One backend solve to `tolerance` (relative to |b|) of the problem that system_ states, in at
  /// most iterations_left_ iterations. b is already projected where the problem is; x holds the
  /// guess. Called again on the residual by `solve` (iterative refinement) while the true residual
  /// is above the tolerance.
  virtual Attempt attempt(std::span<const double> b, std::span<double> x, double tolerance) = 0;
  virtual std::int64_t memory_bytes() const = 0;
  virtual std::string note() const { return {}; }

  SolverOptions options_;
  const System* system_ = nullptr;
  double setup_seconds_ = 0.0;
  double assembly_seconds_ = 0.0;
  std::int64_t iterations_left_ = 0;

 private:
  /// What the system says about an x.
  struct Measured {
    double residual = 0.0;   // true and relative
    double curvature = 0.0;  // x^T A x: positive for any x != 0 that the problem allows
  };
  void require_bound(std::size_t b_size, std::size_t x_size) const;
  void iterate(double norm, std::span<double> x, SolveReport& report);
  Attempt refine(double norm, std::span<double> x, Measured& measured);
  Measured measure(std::span<double> x, double norm);
  std::string verdict(const Attempt& last, const Measured& measured, std::int64_t iterations) const;

  std::uint64_t generation_ = 0;
  double tolerance_ = 0.0;
  std::vector<double> load_;        // Pi b
  std::vector<double> residual_;    // Pi (b - A x)
  std::vector<double> correction_;  // of refinement
  std::vector<double> refined_;     // x + correction
};

/// What holds for a solver whatever it solves: columns of the table of solvers (src/solvers/registry.cpp).
struct SolverTraits {
  bool knows_increment = false;       ///< Stopping::increment
  bool assembles = false;             ///< wants A as a matrix
  bool preconditioned = false;        ///< SolverOptions::preconditioner
  bool takes_options = false;         ///< SolverOptions::petsc_options
  bool holds_centre_of_mass = false;  ///< Scheme 2: still by construction
};
/// Throws ConfigError for an unknown name, listing the names.
const SolverTraits& solver_traits(const std::string& name);

/// Preconditioners of pcg, SolverOptions::preconditioner.
std::vector<std::string> preconditioner_names();
/// Names make_solver accepts, in table order. `available_solvers` leaves out what this build lacks.
std::vector<std::string> solver_names();
std::vector<std::string> available_solvers();
/// Throws ConfigError for an unknown name (listing the names), for a backend this build lacks, and
/// for options that contradict the name (Stopping::increment outside Picard, petsc_options
/// elsewhere).
std::unique_ptr<Solver> make_solver(const SolverOptions& options);

}  // namespace odpd
