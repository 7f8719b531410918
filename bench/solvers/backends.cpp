#include "backends.h"

#include <malloc.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

#include "odpd/core/timer.h"

namespace bench {

namespace {

constexpr int most_repeats = 5;
constexpr double enough_seconds = 1.5;
constexpr double longest_rebind = 5.0;

/// A system that lets multigrid know the rotations. Across a periodic boundary they are no rigid motions, but aggregates
/// are small, and those that cross it are few.
class WithRotations : public odpd::System {
 public:
  explicit WithRotations(const odpd::System& a) : a_(a) {}
  int block_size() const override { return a_.block_size(); }
  std::int64_t nodes() const override { return a_.nodes(); }
  void apply(std::span<const double> x, std::span<double> y) const override { a_.apply(x, y); }
  void block_diagonal(std::span<double> blocks) const override { a_.block_diagonal(blocks); }
  const odpd::BlockCsr& matrix() const override { return a_.matrix(); }
  std::span<const double> positions() const override { return a_.positions(); }
  int space_dimension() const override { return a_.space_dimension(); }
  int periodic_directions() const override { return 0; }
  bool translations_are_null() const override { return a_.translations_are_null(); }
  odpd::Translations translations() const override { return a_.translations(); }
  std::span<const std::vector<double>> null_motions() const override { return a_.null_motions(); }
  odpd::Share share() const override { return a_.share(); }
  bool holds_centre_of_mass() const override { return a_.holds_centre_of_mass(); }
  std::uint64_t generation() const override { return a_.generation(); }

 private:
  const odpd::System& a_;
};

/// How much memory the process gains at most while this lives.
class Growth {
 public:
  Growth() {
    malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << "5";  // the peak counts from here (Linux)
    before_ = status_bytes("VmRSS:");
  }
  double peak_bytes() const { return status_bytes("VmHWM:") - before_; }

 private:
  static double status_bytes(const std::string& key) {
    std::ifstream in("/proc/self/status");
    for (std::string word; in >> word;) {
      double kibibytes = 0.0;
      if (word == key && in >> kibibytes) return 1024.0 * kibibytes;
    }
    return std::numeric_limits<double>::quiet_NaN();
  }
  double before_;
};

odpd::SolverOptions petsc(const std::string& options) {
  return {.name = "petsc", .petsc_options = options};
}

}  // namespace

const std::vector<Backend>& backends() {
  static const std::vector<Backend> all{
      {.name = "pcg", .options = {.name = "pcg"}, .growth_2d = 1.2, .growth_3d = 1.2},
      {.name = "pcg-block-jacobi", .options = {.name = "pcg", .preconditioner = "block-jacobi"}},
      {.name = "petsc-gamg",
       .options = petsc("-ksp_type cg -pc_type gamg"),
       .rotations = true,
       .growth_2d = 1.2,
       .growth_3d = 1.2},
      {.name = "petsc-hypre",
       .options = petsc("-ksp_type cg -pc_type hypre -pc_hypre_boomeramg_nodal_coarsen 4 "
                        "-pc_hypre_boomeramg_coarsen_type HMIS -pc_hypre_boomeramg_interp_type "
                        "ext+i -pc_hypre_boomeramg_strong_threshold 0.5 "
                        "-pc_hypre_boomeramg_agg_nl 1 -pc_hypre_boomeramg_P_max 4"),
       .growth_2d = 1.2,
       .growth_3d = 1.2},
      {.name = "petsc-icc", .options = petsc("-ksp_type cg -pc_type icc -mat_type sbaij")},
      {.name = "petsc-jacobi", .options = petsc("-ksp_type cg -pc_type jacobi -mat_type baij")},
      {.name = "eigen-cg", .options = {.name = "eigen-cg"}},
      {.name = "cholmod",
       .options = {.name = "cholmod"},
       .direct = true,
       .growth_2d = 1.5,
       .growth_3d = 2.0,
       .memory_growth = 1.33},
  };
  return all;
}

std::vector<Backend> own_backends() {
  std::vector<Backend> own;
  for (const Backend& backend : backends())
    if (backend.options.name == "pcg") own.push_back(backend);
  return own;
}

bool available(const Backend& backend) {
  const auto names = odpd::available_solvers();
  return std::find(names.begin(), names.end(), backend.options.name) != names.end();
}

template <int D>
Measured measure(Problem<D>& problem, const Backend& backend, double tolerance) {
  odpd::SolverOptions options = backend.options;
  options.tolerance = tolerance;
  problem.rebuild();
  const WithRotations rotating(problem.system());
  const odpd::System& system =
      backend.rotations ? static_cast<const odpd::System&>(rotating) : problem.system();
  Measured best;
  double rebuild = std::numeric_limits<double>::infinity();
  double peak = 0.0;
  int repeats = 0;
  for (double spent = 0.0; repeats < most_repeats && spent < enough_seconds; ++repeats) {
    Measured one;
    rebuild = std::min(rebuild, problem.rebuild());
    one.x.assign(problem.load.size(), 0.0);
    // In the first round only: memory given back to the system costs time to get again.
    std::optional<Growth> growth;
    if (repeats == 0) growth.emplace();
    const auto solver = odpd::make_solver(options);
    const odpd::Stopwatch setup;
    solver->bind(system);
    one.setup = setup.seconds();
    one.report = solver->solve(problem.load, one.x);
    one.solve = one.report.solve_seconds;
    if (growth) peak = growth->peak_bytes();
    one.assembly = one.report.assembly_seconds;
    one.rebind = std::numeric_limits<double>::quiet_NaN();
    if (one.setup < longest_rebind) {
      problem.rebuild();
      const odpd::Stopwatch again;
      solver->bind(system);
      one.rebind = again.seconds();
    }
    spent += one.total() + (one.setup < longest_rebind ? one.rebind : 0.0);
    if (repeats == 0 || one.total() < best.total()) best = std::move(one);
  }
  best.rebuild = rebuild;
  best.peak_bytes = peak;
  best.repeats = repeats;
  return best;
}

template Measured measure(Problem<2>&, const Backend&, double);
template Measured measure(Problem<3>&, const Backend&, double);

}  // namespace bench
