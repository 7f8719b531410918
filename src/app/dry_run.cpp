#include "odpd/app/dry_run.h"

#include <fmt/format.h>

#include "odpd/app/fluid_report.h"
#include "odpd/app/report.h"
#include "odpd/core/parallel.h"

namespace odpd {

namespace {

std::string line(bool yes, const char* what, const std::string& why) {
  return fmt::format("  {} {:<22} {}\n", yes ? "+" : "-", what, why);
}

// Of a scheme that moves the particles in time.
template <int D>
std::string modelled_motion(const Simulation<D>& simulation) {
  const Scene<D>& scene = simulation.scene();
  const bool thermal = scene.model().thermal();
  std::string out = line(thermal, "random force", thermal ? "kT > 0" : "kT = 0");
  const double mass = scene.settings().mass;
  out += line(
      mass > 0.0, "inertia",
      mass > 0.0 ? fmt::format("mass = {}", mass) : "mass = 0: every step is a balance of forces");
  out += line(scene.settings().zeta_0 > 0.0, "uniform drag",
              scene.settings().zeta_0 > 0.0 ? "zeta_0 > 0, with its noise" : "none given");
  const int solves = simulation.integrator().solves();
  out += line(solves > 0, "solves per step",
              fmt::format("{}, integrator {}", solves, simulation.integrator().name()));
  if (solves == 0) return out;
  const std::string& solver = simulation.settings().solver.name;
  out +=
      line(solver_traits(solver).assembles, "assembled matrix", fmt::format("solver {}", solver));
  return out;
}

template <int D>
std::string modelled(const Simulation<D>& simulation) {
  const Scene<D>& scene = simulation.scene();
  std::string out = "Modelled (+) and left out (-)\n";
  out += line(scene.model().conservative(), "conservative force",
              fmt::format("model {}{}", scene.model().name(),
                          scene.model().conservative() ? "" : ", whose pairs have none"));
  if (!simulation.in_time()) {
    out += line(false, "motion in time", "monte-carlo samples equilibrium by trial moves");
  } else {
    out += modelled_motion(simulation);
  }
  out += line(!scene.settings().walls.empty(), "walls",
              fmt::format("{} [[wall]]", scene.settings().walls.size()));
  const bool forced = scene.settings().largest_force() > 0.0;
  out += line(forced, "body force", forced ? "[body_force]" : "none given");
  return out;
}

// One step, or sweep, is tried on the scene that nobody will go on with.
template <int D>
std::string trial_text(Simulation<D>& simulation) {
  const std::string steps = simulation.in_time() ? fmt::format("steps of dt = {}, nothing to solve",
                                                               simulation.clock().dt)
                                                 : std::string("sweeps");
  const Clock clock = simulation.clock();
  const Stopwatch watch;
  simulation.step();
  const double seconds = watch.seconds();
  const Particles<D>& particles = simulation.scene().particles();
  return fmt::format(
      "{}\n  {}D, {}\n"
      "  {} {} ({} of them equilibration), about {:.3g} s at {:.3g} ms each (measured once)\n\n",
      simulation.settings().title, D, population_text(particles), clock.total_steps, steps,
      clock.equilibration_steps, seconds * static_cast<double>(clock.total_steps), 1e3 * seconds);
}

}  // namespace

template <int D>
std::string dry_run_text(Simulation<D>& simulation) {
  const std::string fluid = "\n" + fluid_text(simulation.scene(), Results{});
  if (simulation.integrator().solves() == 0)
    return trial_text(simulation) + modelled(simulation) + fluid;
  Dynamics<D>& dynamics = simulation.dynamics();
  const Clock& clock = simulation.clock();
  const Particles<D>& particles = simulation.scene().particles();
  Stage<D> stage;
  std::vector<Vec<D>> edge_noise;
  const Stopwatch watch;
  dynamics.evaluate(particles.position, clock.time(), stage);
  const std::vector<double> xi = dynamics.draw_noise(stage, clock.step, clock.dt, edge_noise);
  std::vector<double> q(xi.size(), 0.0);
  std::vector<double> load = dynamics.force(stage);
  for (std::size_t k = 0; k < load.size(); ++k) load[k] += xi[k];
  dynamics.solve(stage, load, {dynamics.inertia(clock.dt), 0.0}, q);
  const double stage_seconds = watch.seconds();

  // Two stages of edges, the operator's rows (both directions) and the solver's own memory.
  const std::int64_t rows =
      2 * stage.network.size() * static_cast<std::int64_t>((D + 3) * sizeof(double));
  const double mebibytes =
      static_cast<double>(2 * stage.network.bytes() + rows + stage.report.memory_bytes) /
      (1024.0 * 1024.0);
  std::string out = fmt::format(
      "{}\n  {}D, {}, {} edges ({:.1f} per particle)\n", simulation.settings().title, D,
      population_text(particles), stage.network.size(),
      2.0 * static_cast<double>(stage.network.size()) / static_cast<double>(particles.size()));
  out += fmt::format(
      "  {} steps of dt = {} ({} of them equilibration), solver {}: {} iterations in a first "
      "solve\n",
      clock.total_steps, clock.dt, clock.equilibration_steps, simulation.settings().solver.name,
      stage.report.iterations);
  out += fmt::format(
      "  about {:.1f} MiB, about {:.3g} s at {:.3g} ms per stage (measured once, on {} "
      "thread(s))\n\n",
      mebibytes,
      stage_seconds * simulation.integrator().solves() * static_cast<double>(clock.total_steps),
      1e3 * stage_seconds, threads());
  return out + modelled(simulation) + fluid;
}

template std::string dry_run_text<2>(Simulation<2>&);
template std::string dry_run_text<3>(Simulation<3>&);

}  // namespace odpd
