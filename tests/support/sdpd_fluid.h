#pragma once
// A massless SDPD fluid in 2D at rest: n = eta = K = 1, kT = 0.01, wendland-c2 of support 3, central.
//
// Its reference values are of Metropolis Monte Carlo by a program of its own (2026-11-29), with the energy sum_i psi(d_i) of sdpd.h at the same
// N and box; +- standard errors.
#include <sstream>
#include <string>
#include <vector>

#include "odpd/app/simulation.h"

namespace support {

struct SdpdReference {
  int edge;           ///< of the box, in spacings: N = edge^2
  double background;  ///< p_b
  double energy, energy_error;
  double pressure, pressure_error;
};
inline constexpr SdpdReference sdpd_400{20, 1.0, 0.012893, 8e-6, 0.981683, 17e-6},
    sdpd_144{12, 1.0, 0.012856, 8e-6, 0.981735, 17e-6},
    sdpd_144_without{12, 0.0, 0.002822, 6e-6, 0.042454, 42e-6};

struct SdpdRun {
  const char* integrator = "monte-carlo";
  double dt = 1.0;
  double equilibrate = 0.0, duration = 0.0;
  int every = 2;
  double tolerance = 1e-4;
  const char* more = "";  ///< lines of [fluid], and further tables
};

inline odpd::Results results_of(const std::string& text,
                                const std::vector<std::string>& overrides = {}) {
  const odpd::Config config = odpd::Config::from_text(text, "case.toml", overrides);
  odpd::Simulation<2> simulation(config, odpd::read_case(config, "sdpd"));
  simulation.run([] { return false; }, [] {});
  return simulation.results();
}

/// The fluid with these overrides, which give at least run, and box.size where it is not 20 x 20.
inline odpd::Results sdpd_scene(const std::vector<std::string>& overrides) {
  return results_of(R"(
dimension = 2
[box]
size = [20.0, 20.0]
periodic = [true, true]
[fluid]
model = "sdpd"
density = 1.0
kT = 0.01
eta = 1.0
bulk_modulus = 1.0
[integrator]
dt = 0.3
[solver]
tolerance = 1e-4
)",
                    overrides);
}

inline odpd::Results sdpd_results(const SdpdReference& fluid, const SdpdRun& run) {
  std::ostringstream text;
  text << "dimension = 2\n[box]\nsize = [" << fluid.edge << ".0, " << fluid.edge
       << ".0]\nperiodic = [true, true]\n[fluid]\nmodel = \"sdpd\"\ndensity = 1.0\nkT = 0.01\n"
       << "eta = 1.0\nbulk_modulus = 1.0\nbackground_pressure = " << fluid.background << "\n"
       << run.more << "\n[integrator]\nname = \"" << run.integrator << "\"\ndt = " << run.dt
       << "\n[solver]\ntolerance = " << run.tolerance
       << "\n[run]\nequilibrate = " << run.equilibrate << "\nduration = " << run.duration
       << "\n[[observe]]\nkind = \"thermo\"\nevery = " << run.every << "\n";
  return results_of(text.str());
}

}  // namespace support
