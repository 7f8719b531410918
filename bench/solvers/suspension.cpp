// Suspensions of rigid bodies against a fluid of as many particles: iterations, set-up and solve, the whole step, and the
// best packaged solver of the same P^T R P.
#include "suspension.h"

#include <fmt/format.h>

#include <array>
#include <limits>
#include <memory>

#include "odpd/core/error.h"
#include "odpd/core/parallel.h"
#include "stepped.h"
#include "triad.h"

namespace bench {

namespace {

constexpr std::array shares{0.03, 0.3, 0.9};
constexpr std::array radii{0.5, 1.0, 2.0, 4.0};
constexpr double step_tolerance = 1e-5;
constexpr double usual_radius = 1.0;  // where all radii would take too long
constexpr int rounds = 8;

/// Above a share of 0.6 no random places are found, so the bodies begin on a lattice. Large balls (3D) are filled: a sphere
/// with sites on its surface alone lets the fluid's particles in, who are rattlers there, and has so few sites that packed
/// ones leave room for few of the fluid's.
template <int D>
BodySpec bodies_of(double share, double radius) {
  BodySpec spec{.share = share, .radius = radius};
  spec.packed = share > 0.6;
  if (spec.packed) spec.gap = 0.05;
  if (D == 3) spec.spacing = 0.55;  // nearest ones are at 0.45 on the golden spiral
  if (D == 3 && radius >= 2.0) {
    spec.shape = SiteShape::filled;
    spec.spacing = 0.45;
  }
  return spec;
}

std::string count(std::int64_t n) { return n < 0 ? "-" : std::to_string(n); }

/// Smallest distance of two sites.
template <int D>
double nearest_sites(const std::vector<odpd::Vec<D>>& frame) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < frame.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) least = std::min(least, norm(frame[i] - frame[j]));
  return least;
}

/// All suspensions of one number of particles.
template <int D>
class Suspensions {
 public:
  Suspensions(const Options& options, SuspensionTables& tables, std::int64_t size)
      : options_(options), tables_(tables), fluid_spec_{.particles = size} {}

  void run() {
    fluid_alone();
    for (const double share : shares)
      for (const double radius : radii)
        if (fluid_spec_.particles <= largest_aged || radius == usual_radius) run(share, radius);
  }

 private:
  /// Fifty steps of a million particles only once.
  bool ages(double share, double radius) const {
    return fluid_spec_.particles <= largest_aged || (share == 0.3 && radius == usual_radius);
  }
  void fluid_alone();
  void run(double share, double radius);
  void solves(const std::vector<std::string>& key, const FluidSpec& spec, const Start<D>& start);
  void steps(const std::vector<std::string>& key, const FluidSpec& spec, const Start<D>& start);
  void packaged(const std::vector<std::string>& key, const FluidSpec& spec, const Start<D>& start);
  std::vector<std::string> key(double share, double radius) const {
    return {std::to_string(D), std::to_string(fluid_spec_.particles), fmt::format("{:g}", share),
            fmt::format("{:g}", radius)};
  }
  const Start<D>& fluid_start() {
    if (fluid_start_.empty()) fluid_start_ = equilibrated<D>(fluid_spec_);
    return fluid_start_;
  }

  const Options& options_;
  SuspensionTables& tables_;
  FluidSpec fluid_spec_;
  Start<D> fluid_start_;
  std::unique_ptr<Problem<D>> fluid_;
};

template <int D>
void Suspensions<D>::fluid_alone() {
  std::vector<std::string> row = key(0.0, 0.0);
  if (tables_.scenes.has(row)) return;
  Problem<D> problem(fluid_spec_, fluid_start());
  const Measured m = measure(problem, own_backends().front(), suspension_tolerance);
  const Aged old = ages(0.0, 0.0) ? aged<D>(fluid_spec_, fluid_start()) : Aged{};
  row.insert(row.end(), {"ok", "0", "0", "0", "-", digits(problem.neighbours()),
                         std::to_string(m.report.iterations), count(old.last), count(old.most),
                         count(old.fallbacks)});
  const std::array seconds{m.setup, m.rebind, m.solve};
  for (int side = 0; side < 2; ++side)
    for (const double s : seconds) row.push_back(digits(s));
  row.insert(row.end(), {"-"});
  tables_.scenes.add(row);
  say(fmt::format("{}D N = {:<8} fluid: {} iterations, {} after {} steps", D, fluid_spec_.particles,
                  m.report.iterations, count(old.last), aged_steps));
}

template <int D>
void Suspensions<D>::run(double share, double radius) {
  FluidSpec spec = fluid_spec_;
  spec.bodies = bodies_of<D>(share, radius);
  const std::vector<std::string> names = key(share, radius);
  try {
    const std::size_t row = tables_.scenes.find(names);
    if (row < tables_.scenes.size() && tables_.scenes.word(row, "status") != "ok") return;
    const Start<D> start = equilibrated<D>(spec);
    solves(names, spec, start);
    steps(names, spec, start);
    packaged(names, spec, start);
  } catch (const odpd::Error& e) {
    std::vector<std::string> cells = names;
    const bool room = dynamic_cast<const odpd::ConfigError*>(&e) != nullptr;
    cells.push_back(room ? "left out" : "failed");
    cells.resize(tables_.scenes.columns() - 1, "-");
    cells.emplace_back(e.what());
    tables_.scenes.add(cells);
    say(fmt::format("{}D N = {:<8} share {:g}, radius {:g}: {}", D, spec.particles, share, radius,
                    e.what()));
  }
}

/// Alternating with the fluid, the better of two.
template <int D>
void Suspensions<D>::solves(const std::vector<std::string>& key, const FluidSpec& spec,
                            const Start<D>& start) {
  if (tables_.scenes.has(key)) return;
  Problem<D> problem(spec, start);
  if (!fluid_) fluid_ = std::make_unique<Problem<D>>(fluid_spec_, fluid_start());
  const Backend pcg = own_backends().front();
  std::array<std::array<double, 3>, 2> least;
  for (auto& side : least) side.fill(std::numeric_limits<double>::infinity());
  Measured first;
  for (int round = 0; round < 2; ++round)
    for (int side = 0; side < 2; ++side) {
      Measured m = measure(side == 0 ? problem : *fluid_, pcg, suspension_tolerance);
      const std::array seconds{m.setup, m.rebind, m.solve};
      for (std::size_t k = 0; k < seconds.size(); ++k)
        least[side][k] = std::min(least[side][k], seconds[k]);
      if (round == 0 && side == 0) first = std::move(m);
    }
  if (!first.report.converged)
    throw odpd::SolverError(first.report.failure, odpd::SolverError::Cause::not_converged);
  if (spec.particles > largest_aged) fluid_.reset();
  const Aged old = ages(spec.bodies->share, spec.bodies->radius) ? aged<D>(spec, start) : Aged{};
  const auto bodies = static_cast<double>(start.bodies.size());
  const std::size_t sites = problem.scene->particles().bodies.front().members.size();
  std::vector<std::string> row = key;
  row.insert(
      row.end(),
      {"ok", std::to_string(sites), std::to_string(start.bodies.size()),
       digits(bodies * static_cast<double>(sites) / static_cast<double>(spec.particles)),
       fmt::format("{:.3g}", nearest_sites<D>(problem.scene->particles().bodies.front().frame)),
       digits(problem.neighbours()), std::to_string(first.report.iterations), count(old.last),
       count(old.most),
       count(old.fallbacks < 0 ? -1 : old.fallbacks + (first.report.note.empty() ? 0 : 1))});
  for (const auto& side : least)
    for (const double seconds : side) row.push_back(digits(seconds));
  row.push_back(first.report.note);
  tables_.scenes.add(row);
  say(
      fmt::format("{}D N = {:<8} share {}, radius {}: {} iterations, {} after {} steps; set-up and "
                  "solve {:.3g} of the fluid's",
                  D, spec.particles, key[2], key[3], first.report.iterations, count(old.last),
                  aged_steps, (least[0][1] + least[0][2]) / (least[1][1] + least[1][2])));
}

/// In rounds that alternate; the faster round of each.
template <int D>
void Suspensions<D>::steps(const std::vector<std::string>& key, const FluidSpec& spec,
                           const Start<D>& start) {
  std::array<std::vector<std::string>, 2> rows{key, key};
  rows[0].push_back("bodies");
  rows[1].push_back("fluid");
  if (tables_.steps.has(rows[0])) return;
  if (spec.particles > largest_aged) return;
  const std::int64_t all = spec.particles <= 20000 ? 40 : 8;
  const auto bodies = scene_at<D>(spec, start);
  const auto fluid = scene_at<D>(fluid_spec_, fluid_start());
  Stepped<D> with(*bodies, step_tolerance), without(*fluid, step_tolerance);
  std::array<StepTimes, 2> best;
  for (int round = 0; round < rounds; ++round) {
    const std::array now{with.advance(all / rounds), without.advance(all / rounds)};
    for (std::size_t side = 0; side < 2; ++side)
      if (round == 0 || now[side].all < best[side].all) best[side] = now[side];
  }
  for (std::size_t side = 0; side < 2; ++side) {
    for (const double value : best[side].columns()) rows[side].push_back(digits(value));
    tables_.steps.add(rows[side]);
  }
  say(
      fmt::format("{}D N = {:<8} share {}, radius {}: a step takes {:.4g} ns per particle, {:.3g} "
                  "of the fluid's",
                  D, spec.particles, key[2], key[3], best[0].all, best[0].all / best[1].all));
}

template <int D>
void Suspensions<D>::packaged(const std::vector<std::string>& key, const FluidSpec& spec,
                              const Start<D>& start) {
  if (spec.particles > largest_aged || spec.bodies->radius != usual_radius) return;
  const std::vector<std::string> name{key[0], suspension_name(key[2], key[3]), key[1]};
  std::unique_ptr<Problem<D>> problem;
  for (const Backend& backend : options_.chosen()) {
    if (backend.name == own_backends().back().name) continue;
    add_solve(tables_.backends, options_, backend, name, suspension_tolerance, [&](double at) {
      if (!problem) problem = std::make_unique<Problem<D>>(spec, start);
      const Measured m = measure(*problem, backend, at);
      constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
      return solved_cells(m, unknown, spec.particles, unknown);
    });
  }
}

}  // namespace

template <int D>
Aged aged(const FluidSpec& spec, const Start<D>& start) {
  const auto scene = scene_at<D>(spec, start);
  odpd::Dynamics<D> dynamics(scene->box(), scene->particles(), scene->model(), *scene,
                             odpd::make_solver({.name = "pcg", .tolerance = suspension_tolerance}),
                             {.seed = seed});
  const auto integrator = odpd::make_integrator<D>("trapezoidal");
  Aged result;
  for (odpd::Clock clock{.dt = time_step}; clock.step <= aged_steps; clock.advance())
    result.last = integrator->step(dynamics, clock).start.report.iterations;
  result.most = dynamics.statistics().most_iterations;
  result.fallbacks = dynamics.statistics().fallbacks;
  return result;
}

template Aged aged<2>(const FluidSpec&, const Start<2>&);
template Aged aged<3>(const FluidSpec&, const Start<3>&);

double allowed_ratio(double spacing) { return spacing >= 0.4 - 1e-9 ? 1.3 : 1.8; }

std::string suspension_name(const std::string& share, const std::string& radius) {
  return "share " + share + "; radius " + radius;
}

void run_suspension(const Options& options) {
  SuspensionTables tables(options.out);
  for (const std::int64_t size : options.sizes) {
    odpd::set_threads(options.threads, size);
    Suspensions<2>(options, tables, size).run();
    Suspensions<3>(options, tables, size).run();
    write_suspension(tables, options.out);
    if (size == options.sizes.front()) run_suspension_robustness(options, tables.robustness);
    run_suspension_growth(options, size, tables.robustness);
    write_suspension(tables, options.out);
  }
}

}  // namespace bench
