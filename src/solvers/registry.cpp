// The name table of the solvers.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "odpd/core/config.h"
#include "odpd/core/error.h"
#include "odpd/solvers/backends.h"
#include "odpd/solvers/solver.h"
#include "odpd/version.h"

namespace odpd {

namespace {

struct Row {
  const char* name;
  std::unique_ptr<Solver> (*make)(const SolverOptions&);  // null: not in this build
  SolverTraits traits;
};

#if ODPD_WITH_PETSC
constexpr auto petsc_maker = &make_petsc;
#else
constexpr std::unique_ptr<Solver> (*petsc_maker)(const SolverOptions&) = nullptr;
#endif

constexpr std::array<Row, 6> table{
    {{"picard", &make_picard, {.knows_increment = true}},
     {"picard-deflated",
      &make_picard_deflated,
      {.knows_increment = true, .holds_centre_of_mass = true}},
     {"pcg", &make_pcg, {.preconditioned = true}},
     {"eigen-cg", &make_eigen_cg, {.assembles = true}},
     {"cholmod", &make_cholmod, {.assembles = true}},
     {"petsc", petsc_maker, {.assembles = true, .takes_options = true}}}};

const Row& find(const std::string& name) {
  const auto row =
      std::find_if(table.begin(), table.end(), [&](const Row& r) { return name == r.name; });
  if (row != table.end()) return *row;
  const std::vector<std::string> names = solver_names();
  const std::string nearest = nearest_name(name, names);
  throw ConfigError(fmt::format("solver.name = \"{}\": no such solver{}; the names are {}", name,
                                nearest.empty() ? "" : ", did you mean \"" + nearest + "\"?",
                                fmt::join(names, ", ")));
}

}  // namespace

const SolverTraits& solver_traits(const std::string& name) { return find(name).traits; }

std::vector<std::string> preconditioner_names() { return {"auto", "multilevel", "block-jacobi"}; }

std::vector<std::string> solver_names() {
  std::vector<std::string> names;
  for (const Row& row : table) names.emplace_back(row.name);
  return names;
}

std::vector<std::string> available_solvers() {
  std::vector<std::string> names;
  for (const Row& row : table) {
    if (row.make != nullptr) names.emplace_back(row.name);
  }
  return names;
}

std::unique_ptr<Solver> make_solver(const SolverOptions& options) {
  const Row& row = find(options.name);
  if (row.make == nullptr) {
    throw ConfigError(fmt::format(
        "solver.name = \"{}\": this build has no PETSc; configure with -DODPD_WITH_PETSC=ON, or "
        "choose one of {}",
        options.name, fmt::join(available_solvers(), ", ")));
  }
  if (!(options.tolerance > 0.0 && options.tolerance < 1.0))
    throw ConfigError(
        fmt::format("solver.tolerance = {} must lie between 0 and 1", options.tolerance));
  if (options.max_iterations < 1)
    throw ConfigError(
        fmt::format("solver.max_iterations = {} must be at least 1", options.max_iterations));
  if (options.stopping == Stopping::increment && !row.traits.knows_increment)
    throw ConfigError(fmt::format(
        "solver.stopping = \"increment\" is the rule of picard and picard-deflated; {} stops by "
        "the residual",
        options.name));
  const std::vector<std::string> preconditioners = preconditioner_names();
  if (std::find(preconditioners.begin(), preconditioners.end(), options.preconditioner) ==
      preconditioners.end())
    throw ConfigError(
        fmt::format("solver.preconditioner = \"{}\": no such preconditioner; the names are {}",
                    options.preconditioner, fmt::join(preconditioners, ", ")));
  if (options.preconditioner != "auto" && !row.traits.preconditioned)
    throw ConfigError(fmt::format(
        "solver.preconditioner is a choice of solver.name = \"pcg\", not of \"{}\"", options.name));
  if (!options.petsc_options.empty() && !row.traits.takes_options)
    throw ConfigError(fmt::format("solver.petsc_options needs solver.name = \"petsc\", not \"{}\"",
                                  options.name));
  return row.make(options);
}

}  // namespace odpd
