#pragma once
// The text of solver.petsc_options: "-ksp_type cg -pc_type icc -ksp_view".
#include <string>
#include <vector>

namespace odpd {

struct PetscOption {
  std::string name;   ///< without the dash
  std::string value;  ///< empty for a flag
};

/// Throws ConfigError for text that is not a list of options, for an option given twice, and for
/// the PETSc options that solver.tolerance and solver.max_iterations stand for.
std::vector<PetscOption> parse_petsc_options(const std::string& text);

/// The value of `name`, or `fallback` when it is not among the options.
std::string petsc_option(const std::vector<PetscOption>& options, const std::string& name,
                         const std::string& fallback);

}  // namespace odpd
