#include "odpd/app/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "odpd/app/run_output.h"
#include "odpd/app/simulation.h"
#include "odpd/core/error.h"
#include "odpd/core/log.h"
#include "odpd/core/parallel.h"
#include "odpd/io/csv.h"
#include "odpd/io/file.h"
#include "odpd/io/gnuplot.h"

namespace odpd {

namespace {

struct Row {
  std::string solver;
  double tolerance = 0.0;
  double velocity_error = 0.0;
  double setup_seconds = 0.0, solve_seconds = 0.0;
  SolveReport report;
  double seconds() const { return setup_seconds + solve_seconds; }
};

// The frozen problem, with and without the centre of mass held, and the tightest answer to each.
template <int D>
struct FrozenProblem {
  SpinResistance<D> as_posed;
  SpinResistance<D> held;
  std::vector<double> b;
  std::vector<double> exact_as_posed, exact_held;
};

// CHOLMOD below this many unknowns, its own refinement to 1e-14; above, CG to 1e-12.
constexpr std::int64_t direct_limit = 60000;

std::vector<double> tightest(const System& system, const std::vector<double>& b) {
  SolverOptions options;
  options.name = system.size() <= direct_limit ? "cholmod" : "pcg";
  options.tolerance = system.size() <= direct_limit ? 1e-13 : 1e-12;
  const auto solver = make_solver(options);
  std::vector<double> x(b.size(), 0.0);
  solver->bind(system);
  const SolveReport report = solver->solve(b, x);
  // At the rounding floor 1e-13 may stay out of reach; what counts is far below every tolerance in use.
  if (!(report.residual < 1e-11))
    throw SolverError(fmt::format("the reference solution could not be found: {}", report.failure));
  // One more correction than any backend makes for itself.
  std::vector<double> residual(b.size()), correction(b.size(), 0.0);
  system.apply(x, residual);
  for (std::size_t k = 0; k < b.size(); ++k) residual[k] = b[k] - residual[k];
  solver->solve(residual, correction);
  for (std::size_t k = 0; k < b.size(); ++k) x[k] += correction[k];
  return x;
}

template <int D>
FrozenProblem<D> freeze(Simulation<D>& simulation, std::int64_t steps) {
  Dynamics<D>& dynamics = simulation.dynamics();
  for (std::int64_t k = 0; k < steps; ++k) simulation.step();
  const Clock& clock = simulation.clock();
  Stage<D> stage;
  std::vector<Vec<D>> edge_noise;
  dynamics.evaluate(dynamics.particles().position, clock.time(), stage);
  const std::vector<double> xi = dynamics.draw_noise(stage, clock.step, clock.dt, edge_noise);
  const bool hold = simulation.settings().dynamics.hold_centre_of_mass;
  FrozenProblem<D> problem{
      SpinResistance<D>(stage.box, hold), SpinResistance<D>(stage.box, true), {}, {}, {}};
  // The first solve of a step with implicit friction.
  problem.b = dynamics.force(stage);
  const double inertia = dynamics.inertia(clock.dt);
  const std::vector<double> momentum =
      dynamics.motion().times_inertia(stage, dynamics.motion().end_velocity(stage), inertia);
  for (std::size_t k = 0; k < problem.b.size(); ++k) problem.b[k] += xi[k] + momentum[k];
  for (SpinResistance<D>* r : {&problem.as_posed, &problem.held})
    r->rebuild(stage.network, dynamics.dofs(), dynamics.particles(), stage.position, stage.arms,
               {inertia, dynamics.constants().zeta_0});
  problem.as_posed.scale_load(problem.b);
  problem.exact_as_posed = tightest(problem.as_posed.system(), problem.b);
  problem.exact_held = tightest(problem.held.system(), problem.b);
  return problem;
}

// |a - b| / |b|, or |a - b| where b is zero (an ideal gas at rest without noise).
double relative_difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> d(a.size());
  for (std::size_t k = 0; k < a.size(); ++k) d[k] = a[k] - b[k];
  const double size = fixed_norm(b);
  return size > 0.0 ? fixed_norm(d) / size : fixed_norm(d);
}

template <int D>
Row measure(const FrozenProblem<D>& problem, SolverOptions options, double tolerance,
            bool increment_rule) {
  const SolverTraits& traits = solver_traits(options.name);
  const System& system =
      traits.holds_centre_of_mass ? problem.held.system() : problem.as_posed.system();
  const std::vector<double>& exact =
      traits.holds_centre_of_mass ? problem.exact_held : problem.exact_as_posed;
  options.tolerance = tolerance;
  options.stopping =
      traits.knows_increment && increment_rule ? Stopping::increment : Stopping::residual;
  if (!traits.takes_options) options.petsc_options.clear();
  if (!traits.preconditioned) options.preconditioner = "auto";
  Row row;
  row.solver = options.name;
  row.tolerance = tolerance;
  // The fastest of three, so that one interruption by the machine does not count.
  for (int repeat = 0; repeat < 3; ++repeat) {
    const auto solver = make_solver(options);
    std::vector<double> x(problem.b.size(), 0.0);
    solver->bind(system);
    const SolveReport report = solver->solve(problem.b, x);
    const double seconds = report.setup_seconds + report.solve_seconds;
    if (repeat == 0 || seconds < row.seconds()) {
      row.setup_seconds = report.setup_seconds;
      row.solve_seconds = report.solve_seconds;
    }
    row.report = report;
    row.velocity_error = relative_difference(x, exact);
    if (row.seconds() > 5.0) break;
  }
  return row;
}

std::string table_text(const std::vector<Row>& rows) {
  std::string out = fmt::format("{:<16} {:>9} {:>10} {:>12} {:>12} {:>11} {:>11} {:>12}  {}\n",
                                "solver", "tolerance", "iterations", "residual", "error in v",
                                "set-up (s)", "solve (s)", "memory", "problem");
  for (const Row& r : rows)
    out += fmt::format(
        "{:<16} {:>9.0e} {:>10} {:>12.3e} {:>12.3e} {:>11.3e} {:>11.3e} {:>8.0f} KiB  {}\n",
        r.solver, r.tolerance, r.report.iterations, r.report.residual, r.velocity_error,
        r.setup_seconds, r.solve_seconds, static_cast<double>(r.report.memory_bytes) / 1024.0,
        r.report.converged ? r.report.problem : "NOT CONVERGED: " + r.report.failure);
  return out;
}

void write_rows(const std::filesystem::path& file, const std::vector<Row>& rows) {
  std::string text =
      "solver,tolerance,converged,iterations,residual,velocity_error,setup_seconds,solve_seconds,"
      "memory_bytes,problem\n";
  for (const Row& r : rows)
    text += fmt::format("{},{},{},{},{},{},{},{},{},\"{}\"\n", r.solver, r.tolerance,
                        r.report.converged ? 1 : 0, r.report.iterations, r.report.residual,
                        r.velocity_error, r.setup_seconds, r.solve_seconds, r.report.memory_bytes,
                        r.report.problem);
  write_file_atomically(file, text);
}

Chart chart_of(const std::vector<Row>& rows, const std::string& title) {
  Chart chart{.title = title,
              .x_label = "set-up and solve (s)",
              .y_label = "relative error in v",
              .log_x = true,
              .log_y = true,
              .curves = {}};
  for (const Row& r : rows) {
    if (chart.curves.empty() || chart.curves.back().title != r.solver)
      chart.curves.push_back({.title = r.solver, .x = {}, .y = {}, .error = {}, .line = true});
    if (!r.report.converged || !(r.velocity_error > 0.0)) continue;
    chart.curves.back().x.push_back(r.seconds());
    chart.curves.back().y.push_back(r.velocity_error);
  }
  std::erase_if(chart.curves, [](const Curve& c) { return c.x.empty(); });
  return chart;
}

template <int D>
int compare_in(const CompareOptions& options, const Config& config, const CaseSettings& settings) {
  Simulation<D> simulation(config, settings);
  set_threads(options.threads, simulation.scene().particles().size());
  std::vector<std::string> names = options.solvers.empty() ? available_solvers() : options.solvers;
  for (const std::string& name : names)
    make_solver({.name = name, .petsc_options = {}});  // unknown names fail first
  std::vector<double> tolerances = options.tolerances;
  if (tolerances.empty())
    for (int k = 2; k <= 10; ++k) tolerances.push_back(std::pow(10.0, -k));
  const std::filesystem::path directory =
      options.out.empty() ? std::filesystem::path("runs") / (settings.name + "-compare")
                          : options.out;
  const RunLock lock = prepare_run_directory(directory);
  write_file_atomically(directory / "case.toml", portable_case(config));

  const FrozenProblem<D> problem = freeze(simulation, options.steps);
  fmt::print("{}: {} unknowns in {}D after {} steps; seconds on {} thread(s), fastest of three\n\n",
             settings.title, problem.b.size(), D, options.steps, threads());
  std::vector<Row> rows, shown;
  for (const std::string& name : names)
    for (const double tolerance : tolerances) {
      SolverOptions solver = settings.solver;
      solver.name = name;
      rows.push_back(measure(problem, solver, tolerance, options.increment_rule));
      const double digits = -std::log10(tolerance);
      if (!options.tolerances.empty() || std::abs(digits - 3) < 0.1 || std::abs(digits - 5) < 0.1 ||
          std::abs(digits - 7) < 0.1 || std::abs(digits - 10) < 0.1)
        shown.push_back(rows.back());
    }
  fmt::print("{}", table_text(shown));
  if (std::find(names.begin(), names.end(), "picard-deflated") != names.end() &&
      !settings.dynamics.hold_centre_of_mass && !problem.as_posed.translations_are_null())
    fmt::print(
        "\npicard-deflated (Scheme 2) holds the fluid's centre of mass still: its errors are "
        "against the exact "
        "answer of that problem, which differs from the answer of R v = f by {:.3g} of |v|\n",
        relative_difference(problem.exact_held, problem.exact_as_posed));
  write_rows(directory / "compare.csv", rows);
  if (settings.output.pictures) draw_chart(directory / "compare", chart_of(rows, settings.title));
  fmt::print("\ntable and chart of all tolerances in {}\n", directory.string());
  return std::all_of(rows.begin(), rows.end(), [](const Row& r) { return r.report.converged; }) ? 0
                                                                                                : 2;
}

}  // namespace

int compare_solvers(const CompareOptions& options) {
  const Config config = open_case(options.case_path, options.overrides);
  const CaseSettings settings = read_case(config, case_name(options.case_path));
  return settings.dimension == 2 ? compare_in<2>(options, config, settings)
                                 : compare_in<3>(options, config, settings);
}

}  // namespace odpd
