// The comparison: all backends, the product, and the whole step, on one configuration after the other.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <new>
#include <optional>

#include "backends.h"
#include "benchmark.h"
#include "odpd/core/error.h"
#include "odpd/core/parallel.h"
#include "odpd/core/timer.h"
#include "prediction.h"
#include "product.h"
#include "stepped.h"
#include "triad.h"

namespace bench {

namespace {

constexpr double step_tolerance = 1e-5;
constexpr double reference_tolerance = 1e-11;

double difference(const std::vector<double>& x, const std::vector<double>& y) {
  double square = 0.0;
  double size = 0.0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    square += (x[k] - y[k]) * (x[k] - y[k]);
    size += y[k] * y[k];
  }
  return std::sqrt(square / size);
}

/// All that is measured on one configuration; made of it is only what some missing row needs.
template <int D>
class Comparison {
 public:
  Comparison(const Options& options, Tables& tables, const FluidSpec& spec,
             const std::map<int, double>& triad)
      : options_(options), tables_(tables), spec_(spec), triad_(triad) {}

  void run() {
    for (const Backend& backend : options_.chosen())
      for (const double tolerance : options_.tolerances) solve(backend, tolerance);
    try {
      product();
      problem_.reset();
      for (const int threads : options_.step_threads) step(threads);
    } catch (const odpd::Error& e) {
      say(fmt::format("{}D {:8} N = {:<8} product or step: {}", D, spec_.geometry(),
                      spec_.particles, e.what()));
    }
  }

 private:
  std::vector<std::string> key() const {
    return {std::to_string(D), spec_.geometry(), std::to_string(spec_.particles)};
  }
  const Start<D>& start();
  Problem<D>& problem();
  const std::vector<double>& reference();
  void solve(const Backend& backend, double tolerance);
  std::vector<std::string> solved(const Backend& backend, double tolerance);
  void product();
  void step(int threads);

  const Options& options_;
  Tables& tables_;
  FluidSpec spec_;
  const std::map<int, double>& triad_;  // GB/s by number of threads
  Start<D> start_;
  std::unique_ptr<Problem<D>> problem_;
  std::optional<std::vector<double>> reference_;  // empty: did not converge
};

template <int D>
const Start<D>& Comparison<D>::start() {
  odpd::set_threads(options_.threads, spec_.particles);
  if (start_.empty()) start_ = equilibrated<D>(spec_);
  return start_;
}

template <int D>
Problem<D>& Comparison<D>::problem() {
  if (!problem_) problem_ = std::make_unique<Problem<D>>(spec_, start());
  return *problem_;
}

template <int D>
const std::vector<double>& Comparison<D>::reference() {
  if (reference_) return *reference_;
  problem().rebuild();
  const auto solver = odpd::make_solver({.name = "pcg", .tolerance = reference_tolerance});
  std::vector<double> x(problem().load.size(), 0.0);
  solver->bind(problem().system());
  if (!solver->solve(problem().load, x).converged) x.clear();
  return reference_.emplace(std::move(x));
}

template <int D>
std::vector<std::string> Comparison<D>::solved(const Backend& backend, double tolerance) {
  const Measured m = measure(problem(), backend, tolerance);
  const double error =
      reference().empty() ? std::numeric_limits<double>::quiet_NaN() : difference(m.x, reference());
  return solved_cells(m, error, spec_.particles, triad_.at(options_.threads));
}

template <int D>
void Comparison<D>::solve(const Backend& backend, double tolerance) {
  add_solve(tables_.solves, options_, backend, key(), tolerance,
            [&](double at) { return solved(backend, at); });
}

/// The product with R, in double as the residual has it and packed in single precision as the iteration of pcg has it.
template <int D>
void Comparison<D>::product() {
  for (const int threads : options_.step_threads) {
    std::vector<std::string> row = key();
    row.push_back(std::to_string(threads));
    if (tables_.products.has(row)) continue;
    Problem<D>& p = problem();
    odpd::set_threads(threads, spec_.particles);
    const double rebuild = std::min(p.rebuild(), p.rebuild());
    std::vector<double> y(p.load.size());
    const double apply = best_seconds([&] { p.system().apply(p.load, y); });
    const Packed packed = pack_and_multiply(p.resistance.velocities().mobile());
    const double n = static_cast<double>(spec_.particles);
    row.insert(row.end(),
               {digits(p.neighbours()), digits(1e9 * rebuild / n), digits(1e9 * apply / n),
                digits(1e9 * packed.seconds / n), digits(packed.product_bytes / n),
                digits(packed.iteration_bytes / n), digits(triad_.at(threads))});
    tables_.products.add(row);
    odpd::set_threads(options_.threads, spec_.particles);
  }
}

template <int D>
void Comparison<D>::step(int threads) {
  std::vector<std::string> row = key();
  row.insert(row.end(), {fmt::format("{:g}", step_tolerance), std::to_string(threads)});
  if (tables_.steps.has(row)) return;
  const auto scene = scene_at<D>(spec_, start());
  odpd::set_threads(threads, spec_.particles);
  Stepped<D> stepped(*scene, step_tolerance);
  const std::int64_t steps = spec_.particles <= 20000 ? 20 : spec_.particles <= 200000 ? 5 : 2;
  const auto measured = stepped.advance(steps);
  row.push_back(std::to_string(steps));
  for (const double value : measured.columns()) row.push_back(digits(value));
  tables_.steps.add(row);
  say(fmt::format("{}D {:8} N = {:<8} trapezoidal step, {} thread(s): {} ns per particle", D,
                  spec_.geometry(), spec_.particles, threads, digits(measured.all)));
  odpd::set_threads(options_.threads, spec_.particles);
}

}  // namespace

std::vector<std::string> solved_cells(const Measured& m, double error, std::int64_t particles,
                                      double triad) {
  const double n = static_cast<double>(particles);
  return {m.report.converged ? "ok" : "failed",
          std::to_string(m.report.iterations),
          digits(m.rebuild),
          digits(m.setup),
          digits(m.assembly),
          digits(m.rebind),
          digits(m.solve),
          digits(m.report.residual),
          digits(error),
          digits(static_cast<double>(m.report.memory_bytes) / n),
          digits(m.peak_bytes / n),
          std::to_string(m.repeats),
          digits(triad),
          m.report.failure.empty() ? m.report.note : m.report.failure};
}

void add_solve(Results& solves, const Options& options, const Backend& backend,
               std::vector<std::string> row, double tolerance,
               const std::function<std::vector<std::string>(double tolerance)>& solved) {
  const std::string dimension = row[0], geometry = row[1], size = row[2];
  row.insert(row.end(),
             {backend.name, fmt::format("{:g}", tolerance), std::to_string(options.threads)});
  if (solves.has(row)) return;
  const auto unmeasured = [&](const std::string& status, const std::string& note) {
    row.insert(row.end(),
               {status, "-", "-", "-", "-", "-", "-", "-", "-", "-", "-", "-", "-", note});
  };
  const Prediction expected =
      predict(solves, backend, std::stoi(dimension), geometry, tolerance, std::stoll(size));
  const std::size_t twin = backend.direct ? solved_twin(solves, row) : solves.size();
  if (!available(backend)) {
    unmeasured("skipped", "not in this build");
  } else if (!expected.objection.empty()) {
    unmeasured("skipped", expected.objection);
  } else if (expected.seconds > options.limit_seconds) {
    unmeasured("skipped", fmt::format("would take about {:.0f} s; the limit is {:g} s",
                                      expected.seconds, options.limit_seconds));
  } else if (expected.bytes > 1e9 * options.limit_gigabytes) {
    unmeasured("skipped", fmt::format("would need about {:.2g} GB; the limit is {:g} GB",
                                      1e-9 * expected.bytes, options.limit_gigabytes));
  } else if (twin < solves.size()) {
    for (const char* column : measured_columns) row.push_back(solves.word(twin, column));
  } else {
    try {
      const auto cells = solved(backend.direct ? options.tolerances.back() : tolerance);
      row.insert(row.end(), cells.begin(), cells.end());
    } catch (const odpd::Error& e) {
      unmeasured("failed", e.what());
    } catch (const std::bad_alloc&) {
      unmeasured("failed", "out of memory");
    }
  }
  solves.add(row);
  const std::size_t last = solves.size() - 1;
  const auto cell = [&](const char* column) { return solves.word(last, column); };
  say(fmt::format(
      "{}D {:8} N = {:<8} {:16} {:6} {:>6} iterations, set-up {:>9} s, solve {:>9} s {}", dimension,
      geometry, size, backend.name, cell("tolerance"), cell("iterations"), cell("setup_s"),
      cell("solve_s"), cell("status") == "ok" ? "" : cell("status") + ": " + cell("note")));
}

void run_comparison(const Options& options) {
  Tables tables(options.out);
  std::vector<std::string> names;
  for (const Backend& backend : options.chosen()) names.push_back(backend.name);
  if (options.fresh) tables.solves.forget("backend", names);
  const auto now = std::chrono::duration_cast<std::chrono::seconds>(
                       std::chrono::system_clock::now().time_since_epoch())
                       .count();
  std::map<int, double> triad;
  std::vector<int> counts = options.step_threads;
  counts.push_back(options.threads);
  for (const int threads : counts) {
    if (triad.contains(threads)) continue;
    triad[threads] = triad_bandwidth(threads);
    const std::string bandwidth = digits(triad[threads]);
    tables.triad.add({std::to_string(now), std::to_string(threads), bandwidth});
    say(fmt::format("STREAM triad, {} thread(s): {} GB/s", threads, bandwidth));
  }
  for (const std::int64_t size : options.sizes) {
    for (const bool walls : {false, true}) {
      const FluidSpec spec{.walls = walls, .particles = size};
      Comparison<2>(options, tables, spec, triad).run();
      Comparison<3>(options, tables, spec, triad).run();
    }
    write_comparison(tables, options.out);
    draw_comparison(tables.solves, options.out);
  }
}

}  // namespace bench
