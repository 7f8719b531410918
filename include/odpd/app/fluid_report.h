#pragma once
// The fluid in both languages: the DPD parameters it runs with, what was asked for, what kinetic theory says of it, and
// the viscosity that the run measured, where it measured one.
#include <string>

#include "odpd/analysis/results.h"
#include "odpd/io/json.h"
#include "odpd/scene/scene.h"

namespace odpd {

/// Some lines for the dry run and the report. `results` of a dry run are empty.
template <int D>
std::string fluid_text(const Scene<D>& scene, const Results& results);

/// "fluid" of summary.json: "state", "dpd", "asked_for", "calibration" (where it is), "viscosity_expected" (of SDPD, where
/// pairs/sdpd_expectation.h has a fluid near it), "kinetic_theory", "groups" (dimensionless, of what was
/// measured), "viscosity_measured" (null where none was measured);
/// a number that is infinite is null.
template <int D>
JsonObject fluid_json(const Scene<D>& scene, const Results& results);

/// `viscosity` of the observer of that kind, else the first observable named `<observer>.viscosity`, else nullptr.
const Scalar* measured_viscosity(const Results& results);

/// The viscosity of the fluid as far as a case tells it, without a measurement, and where from: "calibration" (fluid.calibration, times the
/// square of this density over its own), "expected" (of SDPD, by its table), "asked for" (SDPD that is not in it), or else "kinetic theory", at this density.
struct KnownViscosity {
  double eta = 0.0;
  std::string source;
};
template <int D>
KnownViscosity known_viscosity(const Scene<D>& scene, double density);

}  // namespace odpd
