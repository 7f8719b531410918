#pragma once
// The makers behind the name table of make_solver (solver.h).
#include <memory>
#include <string>

#include "odpd/operator/free_motions.h"
#include "odpd/solvers/solver.h"

namespace odpd {

std::unique_ptr<Solver> make_picard(const SolverOptions& options);
std::unique_ptr<Solver> make_picard_deflated(const SolverOptions& options);
std::unique_ptr<Solver> make_pcg(const SolverOptions& options);
std::unique_ptr<Solver> make_eigen_cg(const SolverOptions& options);
std::unique_ptr<Solver> make_cholmod(const SolverOptions& options);
/// Defined only in a build with PETSc.
std::unique_ptr<Solver> make_petsc(const SolverOptions& options);

/// What every backend says of an indefinite matrix.
inline const std::string not_definite =
    std::string(
        "the matrix is not positive definite: check friction weights, masses and stiffness "
        "for negative values, and that every particle is held by enough neighbours, or "
        "give them ") +
    drag_cure + ", or mass (fluid.mass)";

}  // namespace odpd
