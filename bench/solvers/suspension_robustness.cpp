// Iterations to 1e-7 in suspensions where solvers may fail, against a fluid without bodies under the same conditions.
#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "odpd/core/error.h"
#include "odpd/core/parallel.h"
#include "suspension.h"

namespace bench {

namespace {

constexpr std::int64_t usual_particles = 10000;

/// On the golden spiral of a sphere nearest sites are 0.45 apart at a mean spacing of 0.55.
template <int D>
BodySpec usual_bodies() {
  return {.share = 0.3, .radius = 1.0, .spacing = D == 2 ? 0.45 : 0.55};
}

template <int D>
class HardSuspensions {
 public:
  explicit HardSuspensions(Results& results) : results_(results) {}
  void run();
  void grow(std::int64_t particles);

 private:
  using Change = std::function<void(Problem<D>&)>;
  void solve(const std::string& scene, FluidSpec spec, const BodySpec& bodies,
             const Change& change = {}, bool old = false);
  static odpd::SolveReport run_solved(const FluidSpec& spec);
  odpd::SolveReport solved(const FluidSpec& spec, const Change& change);

  Results& results_;
};

template <int D>
odpd::SolveReport HardSuspensions<D>::solved(const FluidSpec& spec, const Change& change) {
  Problem<D> problem(spec, equilibrated<D>(spec));
  if (change) change(problem);
  const auto solver = odpd::make_solver({.name = "pcg", .tolerance = suspension_tolerance});
  problem.rebuild();
  std::vector<double> x(problem.load.size(), 0.0);
  solver->bind(problem.system());
  return solver->solve(problem.load, x);
}

/// The most iterations in a run of 50 steps.
template <int D>
odpd::SolveReport HardSuspensions<D>::run_solved(const FluidSpec& spec) {
  const Aged run = aged<D>(spec, equilibrated<D>(spec));
  odpd::SolveReport report;
  report.converged = true;
  report.iterations = run.most;
  if (run.fallbacks > 0) report.note = fmt::format("{} solves", run.fallbacks);
  return report;
}

template <int D>
void HardSuspensions<D>::solve(const std::string& scene, FluidSpec spec, const BodySpec& bodies,
                               const Change& change, bool old) {
  std::vector<std::string> row{scene, std::to_string(D), std::to_string(spec.particles)};
  if (results_.has(row)) return;
  const double allowed = allowed_ratio(bodies.spacing);
  try {
    const odpd::SolveReport fluid = old ? run_solved(spec) : solved(spec, change);
    spec.bodies = bodies;
    const odpd::SolveReport report = old ? run_solved(spec) : solved(spec, change);
    const double ratio =
        static_cast<double>(report.iterations) / static_cast<double>(fluid.iterations);
    const std::string verdict = !report.converged      ? "failed"
                                : !report.note.empty() ? "fell back"
                                : ratio > allowed      ? "above"
                                                       : "within";
    row.insert(row.end(),
               {std::to_string(report.iterations), std::to_string(fluid.iterations), digits(ratio),
                digits(allowed), verdict, report.converged ? report.note : report.failure});
  } catch (const odpd::Error& e) {
    row.insert(row.end(), {"-", "-", "-", digits(allowed), "failed", e.what()});
  }
  results_.add(row);
  say(fmt::format("{}D N = {} {:32} {} iterations, the fluid {}: {}", D, spec.particles, scene,
                  row[3], row[4], row[7]));
}

template <int D>
void HardSuspensions<D>::run() {
  const BodySpec usual = usual_bodies<D>();
  const FluidSpec fluid{.particles = usual_particles};
  const auto bodies = [&](const std::function<void(BodySpec&)>& change) {
    BodySpec spec = usual;
    change(spec);
    return spec;
  };
  const auto in = [&](const std::function<void(FluidSpec&)>& change) {
    FluidSpec spec = fluid;
    change(spec);
    return spec;
  };
  // Whole unit cells of a lattice: 480 disks of 19 sites, 192 spheres of 48.
  const double sites = D == 2 ? 480 * 19 : 192 * 48;
  const auto packed = [&](const std::string& scene, double share, double gap) {
    solve(scene, in([&](FluidSpec& s) { s.particles = std::llround(sites / share - 0.499); }),
          bodies([&](BodySpec& s) { s.share = share, s.packed = true, s.gap = gap; }));
  };
  packed("touching on a lattice; share 0.96", 0.96, 0.0);
  packed("share 0.99", 0.99, 0.05);
  packed("share 1", 1.0, 0.05);
  for (const double spacing : {0.2, 0.3})
    solve(fmt::format("sites {:g} apart", spacing), fluid,
          bodies([&](BodySpec& s) { s.spacing = spacing; }));
  solve("sites 0.3 apart; share 0.9", fluid, bodies([](BodySpec& s) {
          s.share = 0.9;
          s.spacing = 0.3;
          s.packed = true;
          s.gap = 0.05;
        }));
  for (const double length : {2.0, 6.0})
    solve(fmt::format("rods of length {:g}", length), fluid, bodies([&](BodySpec& s) {
            s.shape = SiteShape::line;
            s.radius = 0.5 * length;
            s.spacing = 0.45;
            s.anywhere = true;
          }));
  solve("box of two cutoffs; radius 0.4", in([](FluidSpec& s) { s.thin = 2.0; }),
        bodies([](BodySpec& s) { s.radius = 0.4; }));
  const auto walls = [](FluidSpec& s) { s.walls = true; };
  solve("walls", in(walls), usual);
  solve("walls; radius 2", in(walls), bodies([](BodySpec& s) {
          s.radius = 2.0;
          if (D == 3) s.shape = SiteShape::filled;
          s.spacing = 0.45;
        }));
  solve("walls; centre of mass held", in([](FluidSpec& s) { s.walls = s.held = true; }), usual);
  const auto sheared = in([](FluidSpec& s) { s.shear = 2.0; });
  solve("shear", sheared, usual);
  solve("shear; share 0.9", sheared, bodies([](BodySpec& s) {
          s.share = 0.9;
          s.packed = true;
          s.gap = 0.05;
        }));
  for (const double shift : {1e-2, 1.0, 1e2})
    solve(fmt::format("mass; 2 m/dt = {:g}", shift), in([&](FluidSpec& s) { s.shift = shift; }),
          usual);
  for (const double ratio : {10.0, 100.0})
    solve(fmt::format("bonds k_c dt = {:g} zeta", ratio), fluid, usual,
          [ratio](Problem<D>& problem) { problem.stiffen(ratio); });
  for (const double exponent : {1.0, 2.0})
    solve(fmt::format("friction s = {:g}", exponent), in([&](FluidSpec& s) { s.s = exponent; }),
          usual);
}

/// Walls and shear: at N = 1e4 `run` has the solver made anew.
template <int D>
void HardSuspensions<D>::grow(std::int64_t particles) {
  const BodySpec usual = usual_bodies<D>();
  const FluidSpec walls{.walls = true, .particles = particles};
  const FluidSpec sheared{.particles = particles, .shear = 2.0};
  solve("walls", walls, usual);
  solve("shear", sheared, usual);
  if (particles > largest_aged) return;
  solve("walls; 50 steps with one solver, the most", walls, usual, {}, true);
  solve("shear; 50 steps with one solver, the most", sheared, usual, {}, true);
}

}  // namespace

void run_suspension_robustness(const Options& options, Results& results) {
  odpd::set_threads(options.threads, usual_particles);
  HardSuspensions<2>(results).run();
  HardSuspensions<3>(results).run();
}

void run_suspension_growth(const Options& options, std::int64_t size, Results& results) {
  odpd::set_threads(options.threads, size);
  HardSuspensions<2>(results).grow(size);
  HardSuspensions<3>(results).grow(size);
}

}  // namespace bench
