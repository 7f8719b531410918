#include "odpd/app/dry_run.h"

#include <fmt/format.h>

#include <algorithm>

#include "odpd/app/memory.h"
#include "odpd/app/report.h"
#include "odpd/app/suspension_report.h"
#include "odpd/core/parallel.h"
#include "odpd/scene/spin_keys.h"

namespace odpd {

namespace {

std::string line(bool yes, const char* what, const std::string& why) {
  return fmt::format("  {} {:<22} {}\n", yes ? "+" : "-", what, why);
}

template <int D>
double solves_of_observers(const Simulation<D>& simulation) {
  double solves = 0.0;
  for (const auto& observer : simulation.observers()) solves += observer->solves();
  return solves;
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
  const std::string spins = spins_text(scene.settings().species);
  out += line(!spins.empty(), "spin", spins.empty() ? "no species has a lever_radius" : spins);
  const int solves = simulation.integrator().solves();
  const double observed = solves_of_observers(simulation);
  out += line(solves > 0, "solves per step",
              fmt::format("{}, integrator {}{}", solves, simulation.integrator().name(),
                          observed > 0.0
                              ? fmt::format(", and {:g} of observers while they measure", observed)
                              : ""));
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

// As run_bytes has it for two stages and pcg; other solvers hold more.
template <int D>
double peak_bytes(const Simulation<D>& simulation, const Stage<D>& stage) {
  const Particles<D>& particles = simulation.scene().particles();
  RunSize size{.particles = static_cast<double>(particles.size()),
               .edges = static_cast<double>(stage.network.size())};
  for (const RigidBody<D>& body : particles.bodies) {
    if (body.known) continue;
    size.bodies += 1.0;
    size.constituents += static_cast<double>(body.members.size());
  }
  for (std::size_t k = 0; k < stage.network.lever_i.size(); ++k)
    if (stage.network.lever_i[k] + stage.network.lever_j[k] > 0.0) size.levers += 1.0;
  double bytes = run_bytes<D>(size);
  // Force, answer and what lies between: of one particle, seven vectors. Of one edge three: slips, tensions and forces by them.
  if (solves_of_observers(simulation) > 0.0)
    bytes += D * sizeof(double) * (7.0 * size.particles + 3.0 * size.edges);
  if (simulation.settings().solver.name != "pcg")
    bytes += static_cast<double>(stage.report.memory_bytes);
  if (simulation.integrator().solves() == 1) bytes -= static_cast<double>(stage.network.bytes());
  return bytes;
}

}  // namespace

template <int D>
std::string dry_run_text(Simulation<D>& simulation) {
  std::string fluid = "\n" + fluid_text(simulation.scene(), Results{});
  if (const std::string text = suspension_text(simulation.scene(), Results{}); !text.empty())
    fluid += "\n" + text;
  if (simulation.integrator().solves() == 0)
    return trial_text(simulation) + modelled(simulation) + fluid;
  const Clock clock = simulation.clock();
  const Particles<D>& particles = simulation.scene().particles();
  // The first step also sets up what later ones keep.
  const StepRecord<D>& record = simulation.step();
  const std::int64_t first_iterations = record.start.report.iterations;
  const Stopwatch watch;
  simulation.step();
  const double seconds = watch.seconds();
  const Stage<D>& stage = record.start;
  const double bytes = peak_bytes(simulation, stage);
  // Solves of observers, as long as those of the run although they may be to a looser tolerance.
  const double measured_steps = static_cast<double>(clock.total_steps - clock.equilibration_steps);
  const double total =
      seconds * static_cast<double>(clock.total_steps) +
      measured_steps * solves_of_observers(simulation) * stage.report.solve_seconds;
  std::string out = fmt::format(
      "{}\n  {}D, {}, {} edges ({:.1f} per particle)\n", simulation.settings().title, D,
      population_text(particles), stage.network.size(),
      2.0 * static_cast<double>(stage.network.size()) / static_cast<double>(particles.size()));
  out += fmt::format(
      "  {} steps of dt = {} ({} of them equilibration), solver {}: {} iterations in a first "
      "solve\n",
      clock.total_steps, clock.dt, clock.equilibration_steps, simulation.settings().solver.name,
      first_iterations);
  out += fmt::format(
      "  about {:.1f} MiB, about {:.3g} s at {:.3g} ms per step (measured once, on {} "
      "thread(s))\n\n",
      bytes / (1024.0 * 1024.0), total,
      1e3 * total / static_cast<double>(std::max<std::int64_t>(1, clock.total_steps)), threads());
  return out + modelled(simulation) + fluid;
}

template std::string dry_run_text<2>(Simulation<2>&);
template std::string dry_run_text<3>(Simulation<3>&);

}  // namespace odpd
