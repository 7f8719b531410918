#include "odpd/app/calibration_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/app/simulation.h"
#include "odpd/core/parallel.h"
#include "odpd/pairs/dpd.h"
#include "odpd/pairs/pair_moments.h"

namespace odpd {

namespace {

// Times in which particles move a fraction of r_c: by diffusion with friction gamma, or freely.
double time_scale(const MeasuredFluid& fluid, double gamma, double diffusing, double free) {
  const double r_c = fluid.dpd.cutoff, kT = fluid.dpd.kT;
  return std::max(diffusing * gamma * r_c * r_c / kT, free * r_c * std::sqrt(fluid.mass / kT));
}

// Well within the limit of explicit repulsion; docs/rheology.md has viscosities at larger and smaller steps.
double time_step(const MeasuredFluid& fluid, double gamma) {
  DpdParameters p = fluid.dpd;
  p.gamma = gamma;
  const double limit = *explicit_step_limit(pair_moments(*make_dpd<2>(p), 1), fluid.mass);
  return std::min(0.6 * limit, time_scale(fluid, gamma, 0.0065, 0.03));
}

Config measuring_case(const MeasuredFluid& fluid, const ViscosityRun& run, double dt) {
  const DpdParameters& p = fluid.dpd;
  std::string edges, periodic;
  for (int c = 0; c < fluid.dimension; ++c) {
    edges += fmt::format("{}{}", c > 0 ? ", " : "", fluid.box_edge());
    periodic += c > 0 ? ", true" : "true";
  }
  const double equilibration = time_scale(fluid, run.gamma, 0.7, 3.0);
  return Config::from_text(
      fmt::format(
          "dimension = {}\nseed = {}\n[box]\nsize = [{}]\nperiodic = [{}]\n"
          "[fluid]\ncount = {}\nmass = {}\nkT = {}\ncutoff = {}\na = {}\ns_bar = {}\n"
          "gamma = {}\ns = {}\n{}[shear]\nflow = \"x\"\ngradient = \"y\"\nrate = {}\n"
          "[integrator]\nname = \"trapezoidal\"\ndt = {}\n[solver]\ntolerance = 1e-4\n"
          "[run]\nequilibrate = {}\nduration = {}\n"
          "[[observe]]\nkind = \"viscosity\"\n[[observe]]\nkind = \"thermo\"\nevery = 1000000\n"
          "[[observe]]\nkind = \"msd\"\nevery = 1000000\n",
          fluid.dimension, run.seed, edges, periodic, fluid.particles, fluid.mass, p.kT, p.cutoff,
          p.a, p.s_bar, run.gamma, p.s, rattler_line(p), run.shear_rate, dt, equilibration,
          1e12 * dt),
      "measuring scene");
}

// The box fluctuates by so much at least: an estimate of the error from few blocks may be far below.
double expected_error(const MeasuredFluid& fluid, const ViscosityRun& run, double eta,
                      double time) {
  const double volume = std::pow(fluid.box_edge(), fluid.dimension);
  return std::sqrt(2.0 * fluid.dpd.kT / (eta * volume * time)) / std::abs(run.shear_rate);
}

template <int D>
ViscosityMeasurement measure_in(const MeasuredFluid& fluid, const ViscosityRun& run,
                                const std::function<bool()>& stop) {
  const double dt = time_step(fluid, run.gamma);
  const Config config = measuring_case(fluid, run, dt);
  Simulation<D> simulation(config, read_case(config, "measuring scene"));
  set_threads(run.threads, simulation.scene().particles().size());
  ViscosityMeasurement m{.gamma = run.gamma,
                         .shear_rate = run.shear_rate,
                         .dt = dt,
                         .seed = run.seed,
                         .complete = false};
  const auto look = [&] {
    const Results results = simulation.results();
    const Scalar* eta = results.find("viscosity");
    m.eta = eta->mean;
    m.error = eta->standard_error;
    m.time = static_cast<double>(simulation.clock().measured_steps()) * dt;
    m.complete = m.eta > 0.0 && m.error <= run.relative_error * m.eta &&
                 expected_error(fluid, run, m.eta, m.time) <= 1.4 * run.relative_error;
  };
  constexpr std::int64_t interval = 64;  // steps between two looks
  simulation.run([&] { return m.complete || stop(); },
                 [&] {
                   const Clock& clock = simulation.clock();
                   if (clock.measuring() && clock.measured_steps() % interval == 0) look();
                 });
  if (simulation.clock().measuring()) look();
  return m;
}

}  // namespace

std::string rattler_line(const DpdParameters& p) {
  if (p.gamma_far == 0.0) return {};
  return fmt::format("rattler_friction = {{ gamma = {}, cutoff = {} }}\n", p.gamma_far,
                     p.cutoff_far);
}

double MeasuredFluid::box_edge() const {
  return std::pow(static_cast<double>(particles) / density, 1.0 / dimension);
}

std::int64_t default_particles(int dimension, double density, double cutoff) {
  const double edge = (dimension > 2 ? 6.0 : 8.0) * cutoff;
  return std::max<std::int64_t>(1, std::llround(density * std::pow(edge, dimension)));
}

double default_shear_rate(const MeasuredFluid& fluid, double gamma) {
  const double r_c = fluid.dpd.cutoff, kT = fluid.dpd.kT;
  const double massless = 9.0 * kT / (gamma * r_c * r_c);
  return fluid.mass > 0.0 ? std::min(massless, 0.5 * std::sqrt(kT / fluid.mass) / r_c) : massless;
}

ViscosityMeasurement measure_viscosity(const MeasuredFluid& fluid, const ViscosityRun& run,
                                       const std::function<bool()>& stop) {
  return fluid.dimension == 2 ? measure_in<2>(fluid, run, stop) : measure_in<3>(fluid, run, stop);
}

}  // namespace odpd
