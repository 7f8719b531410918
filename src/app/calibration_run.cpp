#include "odpd/app/calibration_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/app/simulation.h"
#include "odpd/core/parallel.h"

namespace odpd {

namespace {

// Times in which particles move a fraction of r_c: by diffusion, or freely.
double time_scale(const MeasuredFluid& fluid, double friction, double diffusing, double free) {
  const CalibratedModel& m = *fluid.model;
  return std::max(diffusing * m.diffusion_time(friction),
                  free * m.cutoff() * std::sqrt(fluid.mass / m.kT()));
}

double time_step(const MeasuredFluid& fluid, double friction) {
  return std::min(fluid.model->accurate_step(friction, fluid.mass),
                  time_scale(fluid, friction, 0.0065, 0.03));
}

Config measuring_case(const MeasuredFluid& fluid, const ViscosityRun& run, double dt) {
  std::string edges, periodic;
  for (int c = 0; c < fluid.dimension; ++c) {
    edges += fmt::format("{}{}", c > 0 ? ", " : "", fluid.box_edge());
    periodic += c > 0 ? ", true" : "true";
  }
  const double equilibration = time_scale(fluid, run.gamma, 0.7, 3.0);
  return Config::from_text(
      fmt::format(
          "dimension = {}\nseed = {}\n[box]\nsize = [{}]\nperiodic = [{}]\n"
          "[fluid]\ncount = {}\nmass = {}\n{}{} = {}\n[shear]\nflow = \"x\"\ngradient = \"y\"\n"
          "rate = {}\n[integrator]\nname = \"trapezoidal\"\ndt = {}\n[solver]\ntolerance = 1e-4\n"
          "[run]\nequilibrate = {}\nduration = {}\n"
          "[[observe]]\nkind = \"viscosity\"\ncontrol = {}\n[[observe]]\nkind = \"thermo\"\n"
          "every = 1000000\n[[observe]]\nkind = \"msd\"\nevery = 1000000\n",
          fluid.dimension, run.seed, edges, periodic, fluid.particles, fluid.mass,
          fluid.model->keys(), fluid.model->key(), run.gamma, run.shear_rate, dt, equilibration,
          1e12 * dt, fluid.mass == 0.0),
      "measuring scene");
}

// The box fluctuates by so much at least: an estimate of the error from few blocks may be far below. Of a massless fluid what
// friction has of eta does not; what is left lasts as long as structure does, so that this is then the error.
double expected_error(const MeasuredFluid& fluid, const ViscosityRun& run, const Results& results,
                      double eta, double time) {
  const double volume = std::pow(fluid.box_edge(), fluid.dimension);
  const Scalar* frozen = results.find("viscosity.frozen");
  const double share = frozen == nullptr ? 1.0 : std::max(0.05, 1.0 - frozen->mean / eta);
  return std::sqrt(2.0 * fluid.model->kT() * share / (eta * volume * time)) /
         std::abs(run.shear_rate);
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
    if (!(m.eta > 0.0)) return;
    const double expected = expected_error(fluid, run, results, m.eta, m.time);
    if (fluid.mass == 0.0) m.error = std::max(m.error, expected * m.eta);
    m.complete = m.error <= run.relative_error * m.eta && expected <= 1.4 * run.relative_error;
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

double MeasuredFluid::box_edge() const {
  return std::pow(static_cast<double>(particles) / density, 1.0 / dimension);
}

std::int64_t default_particles(int dimension, double density, double cutoff) {
  const double edge = (dimension > 2 ? 6.0 : 8.0) * cutoff;
  return std::max<std::int64_t>(1, std::llround(density * std::pow(edge, dimension)));
}

double default_shear_rate(const MeasuredFluid& fluid, double friction) {
  const CalibratedModel& m = *fluid.model;
  const double massless = 9.0 / m.diffusion_time(friction);
  return fluid.mass > 0.0 ? std::min(massless, 0.5 * std::sqrt(m.kT() / fluid.mass) / m.cutoff())
                          : massless;
}

ViscosityMeasurement measure_viscosity(const MeasuredFluid& fluid, const ViscosityRun& run,
                                       const std::function<bool()>& stop) {
  return fluid.dimension == 2 ? measure_in<2>(fluid, run, stop) : measure_in<3>(fluid, run, stop);
}

}  // namespace odpd
