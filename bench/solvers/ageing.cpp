// Iterations over 50 steps with one solver object: what a preconditioner that is reused between steps loses.
#include <fmt/format.h>

#include <array>

#include "backends.h"
#include "benchmark.h"
#include "odpd/core/error.h"
#include "odpd/core/parallel.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/io/file.h"

namespace bench {

namespace {

constexpr std::array<std::int64_t, 7> shown_steps{0, 1, 2, 5, 10, 20, 50};
constexpr double tolerance = 1e-7;

template <int D>
void age(const FluidSpec& spec, Results& results) {
  Start<D> start;
  for (const Backend& backend : own_backends()) {
    std::vector<std::string> row{std::to_string(D), spec.geometry(), std::to_string(spec.particles),
                                 backend.name};
    if (results.has(row)) continue;
    if (start.empty()) start = equilibrated<D>(spec);
    const auto scene = scene_at<D>(spec, start);
    odpd::SolverOptions options = backend.options;
    options.tolerance = tolerance;
    odpd::Dynamics<D> dynamics(scene->box(), scene->particles(), scene->model(), *scene,
                               odpd::make_solver(options), {.seed = seed});
    const auto integrator = odpd::make_integrator<D>("trapezoidal");
    odpd::Clock clock{.dt = time_step};
    std::string note;
    double setup = 0.0, solve = 0.0;
    try {
      for (const std::int64_t shown : shown_steps) {
        const odpd::StepRecord<D>* record = nullptr;
        for (; clock.step <= shown; clock.advance()) {
          record = &integrator->step(dynamics, clock);
          for (const odpd::Stage<D>* stage : {&record->start, &record->corrector}) {
            setup += stage->report.setup_seconds;
            solve += stage->report.solve_seconds;
          }
        }
        row.push_back(fmt::format("{} + {}", record->start.report.iterations,
                                  record->corrector.report.iterations));
      }
    } catch (const odpd::Error& e) {
      note = e.what();
    }
    row.resize(4 + shown_steps.size());
    const double solves = 2.0 * static_cast<double>(clock.step);
    row.insert(row.end(), {digits(setup / solves), digits(solve / solves), note});
    results.add(row);
    say(fmt::format("{}D {:8} N = {} {}: iterations of step 0: {}, of step 50: {} {}", D,
                    spec.geometry(), spec.particles, backend.name, row[4],
                    row[3 + shown_steps.size()], note));
  }
}

}  // namespace

Results ageing_results(const std::filesystem::path& out) {
  std::vector<std::string> columns{"dimension", "geometry", "N", "backend"};
  for (const std::int64_t step : shown_steps) columns.push_back(fmt::format("step_{}", step));
  columns.insert(columns.end(), {"mean_setup_s", "mean_solve_s", "note"});
  return {out / "ageing.csv", columns, 4};
}

void run_ageing(const Options& options) {
  Results results = ageing_results(options.out);
  for (const std::int64_t size : options.sizes)
    for (const bool walls : {false, true}) {
      odpd::set_threads(options.threads, size);
      const FluidSpec spec{.walls = walls, .particles = size};
      age<2>(spec, results);
      age<3>(spec, results);
    }
  std::string text = table_head("Iterations at 1e-7 over 50 trapezoidal steps, one solver object");
  text +=
      "\nEach cell: first + second solve of the step; the second starts from the first's "
      "answer.\n\n";
  std::vector<std::string> head{"", "N", "backend"};
  for (const std::int64_t step : shown_steps) head.push_back(fmt::format("step {}", step));
  head.insert(head.end(), {"mean set-up s", "mean solve s", "note"});
  text += markdown_head(head);
  for (std::size_t k = 0; k < results.size(); ++k) {
    std::vector<std::string> cells{
        results.word(k, "dimension") + "D " + results.word(k, "geometry"), results.word(k, "N"),
        results.word(k, "backend")};
    for (const std::int64_t step : shown_steps)
      cells.push_back(results.word(k, fmt::format("step_{}", step)));
    for (const char* column : {"mean_setup_s", "mean_solve_s", "note"})
      cells.push_back(results.word(k, column));
    text += markdown_row(cells);
  }
  odpd::write_file_atomically(options.out / "ageing.md", text);
}

}  // namespace bench
