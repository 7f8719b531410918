// Iterations to 1e-7 where solvers may fail: other densities and friction weights, obstacles, gaps, stiff bonds, shifts,
// rattlers, thin boxes, SDPD.
#include <fmt/format.h>

#include <functional>
#include <map>
#include <tuple>

#include "backends.h"
#include "benchmark.h"
#include "odpd/core/error.h"
#include "odpd/core/parallel.h"
#include "odpd/io/file.h"

namespace bench {

namespace {

constexpr double tolerance = 1e-7;
constexpr double thinnest = 2.0;  // cutoffs: below that nearest images are ambiguous

template <int D>
using Change = std::function<void(Problem<D>&)>;

template <int D>
class Robustness {
 public:
  /// `scenes`: a part of the names of those that are wanted.
  Robustness(std::int64_t particles, std::string scenes, Results& results)
      : particles_(particles), scenes_(std::move(scenes)), results_(results) {}
  void run();

 private:
  void fluids(bool walls);
  void sdpd(bool walls);
  void spins(bool walls);
  void obstacles();
  void gaps(bool walls);
  void bonds(bool walls);
  void shifts(bool walls);
  void rattlers(bool walls);
  void thin_boxes(bool walls);
  void solve(const std::string& scene, const FluidSpec& spec, const Change<D>& change = {});
  std::vector<std::string> solved(const Backend& backend, Problem<D>& problem);
  const Start<D>& start(const FluidSpec& spec);

  std::int64_t particles_;
  std::string scenes_;
  Results& results_;
  std::map<std::tuple<bool, double, double, double>, Start<D>> starts_;
};

/// Positions do not depend on friction: one start per density and box.
template <int D>
const Start<D>& Robustness<D>::start(const FluidSpec& spec) {
  auto& made = starts_[{spec.walls, spec.density, spec.thin, spec.support}];
  if (made.empty())
    made = equilibrated<D>({.walls = spec.walls,
                            .particles = spec.particles,
                            .density = spec.density,
                            .support = spec.support,
                            .thin = spec.thin});
  return made;
}

template <int D>
std::vector<std::string> Robustness<D>::solved(const Backend& backend, Problem<D>& problem) {
  odpd::SolverOptions options = backend.options;
  options.tolerance = tolerance;
  const auto solver = odpd::make_solver(options);
  solver->bind(problem.system());
  std::vector<double> x(problem.load.size(), 0.0);
  const odpd::SolveReport report = solver->solve(problem.load, x);
  return {std::to_string(report.iterations), report.converged ? "yes" : "no",
          digits(report.residual),           digits(report.setup_seconds),
          digits(report.solve_seconds),      report.failure};
}

template <int D>
void Robustness<D>::solve(const std::string& scene, const FluidSpec& spec,
                          const Change<D>& change) {
  if (scene.find(scenes_) == std::string::npos) return;
  for (const Backend& backend : own_backends()) {
    std::vector<std::string> row{scene, std::to_string(D), spec.geometry(),
                                 std::to_string(spec.particles), backend.name};
    if (results_.has(row)) continue;
    try {
      Problem<D> problem(spec, start(spec));
      if (change) change(problem);
      problem.rebuild();
      const auto cells = solved(backend, problem);
      row.insert(row.end(), cells.begin(), cells.end());
    } catch (const odpd::Error& e) {
      row.resize(5);
      row.insert(row.end(), {"-", "no", "-", "-", "-", e.what()});
    }
    results_.add(row);
    say(fmt::format("{}D {:8} N = {} {:28} {}: {} iterations, converged: {} {}", D, spec.geometry(),
                    spec.particles, scene, backend.name, row[5], row[6],
                    row.back() == "-" ? "" : row.back()));
  }
}

template <int D>
void Robustness<D>::fluids(bool walls) {
  for (const double density : {3.0, 4.0, 6.0, 10.0})
    for (const double s : {0.5, 1.0, 2.0})
      solve(fmt::format("fluid n = {:g}; s = {:g}", density, s),
            {.walls = walls, .particles = particles_, .density = density, .s = s});
}

template <int D>
void Robustness<D>::sdpd(bool walls) {
  for (const double support : {2.5, 3.0, 4.0})
    for (const bool classical : {false, true})
      if (D == 2 || support < 4.0)
        solve(
            fmt::format("sdpd h = {:g}; {}", support, classical ? "classical" : "central"),
            {.walls = walls, .particles = particles_, .support = support, .classical = classical});
}

/// Friction across lines of centres, and who spins of it: nobody, one in a hundred, all. (Without spins it is no viscous fluid.)
template <int D>
void Robustness<D>::spins(bool walls) {
  for (const double gamma_perp : {2.25, 4.5, 9.0})
    for (const double spinning : {0.0, 0.01, 1.0})
      solve(fmt::format("gamma_perp = {:g}; spinning {:g}", gamma_perp, spinning),
            {.walls = walls,
             .particles = particles_,
             .gamma_perp = gamma_perp,
             .spinning = spinning});
}

template <int D>
void Robustness<D>::obstacles() {
  for (const std::int64_t count : {std::int64_t{4}, std::int64_t{20}})
    solve(fmt::format("obstacle of {} particles", count),
          {.particles = particles_, .obstacle = count});
}

template <int D>
void Robustness<D>::gaps(bool walls) {
  solve("gap", {.walls = walls, .particles = particles_, .gap = true});
  solve("gap; far friction",
        {.walls = walls, .particles = particles_, .gap = true, .far_friction = true});
}

template <int D>
void Robustness<D>::bonds(bool walls) {
  for (const double ratio : {10.0, 100.0, 1000.0})
    solve(fmt::format("bonds k_c dt = {:g} zeta", ratio), {.walls = walls, .particles = particles_},
          [ratio](Problem<D>& problem) { problem.stiffen(ratio); });
}

template <int D>
void Robustness<D>::shifts(bool walls) {
  for (const double shift : {1e-3, 1e-2, 1e-1, 1.0, 1e1, 1e2, 1e3})
    solve(fmt::format("shift {:g}", shift),
          {.walls = walls, .particles = particles_, .shift = shift});
}

template <int D>
void Robustness<D>::rattlers(bool walls) {
  for (const double density : {1.5, 2.0})
    solve(fmt::format("n = {:g}; drag 0.05", density),
          {.walls = walls, .particles = particles_, .density = density, .shift = 0.05});
}

template <int D>
void Robustness<D>::thin_boxes(bool walls) {
  solve("thin box", {.walls = walls, .particles = particles_, .thin = thinnest});
}

template <int D>
void Robustness<D>::run() {
  for (const bool walls : {false, true}) {
    fluids(walls);
    sdpd(walls);
    spins(walls);
    if (!walls) obstacles();
    gaps(walls);
    bonds(walls);
    shifts(walls);
    rattlers(walls);
    thin_boxes(walls);
  }
}

}  // namespace

Results robustness_results(const std::filesystem::path& out) {
  return {out / "robustness.csv",
          {"scene", "dimension", "geometry", "N", "backend", "iterations", "converged", "residual",
           "setup_s", "solve_s", "note"},
          5};
}

void run_robustness(const Options& options) {
  Results results = robustness_results(options.out);
  for (const std::int64_t size : options.sizes) {
    odpd::set_threads(options.threads, size);
    Robustness<2>(size, options.scenes, results).run();
    Robustness<3>(size, options.scenes, results).run();
  }
  std::string text =
      table_head("Iterations to a true residual of 1e-7 in scenes that are not the benchmark's");
  text += "\n" + markdown_head({"scene", "", "N", "backend", "iterations", "converged", "residual",
                                "solve s", "note"});
  for (std::size_t k = 0; k < results.size(); ++k)
    text += markdown_row(
        {results.word(k, "scene"),
         results.word(k, "dimension") + "D " + results.word(k, "geometry"), results.word(k, "N"),
         results.word(k, "backend"), results.word(k, "iterations"), results.word(k, "converged"),
         results.word(k, "residual"), results.word(k, "solve_s"), results.word(k, "note")});
  odpd::write_file_atomically(options.out / "robustness.md", text);
}

}  // namespace bench
