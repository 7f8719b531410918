#pragma once
// One measurement of the viscosity of a fluid, in a scene of its own: a periodic cube sheared by its sliding images
// (Lees-Edwards), trapezoidal steps; eta is the mean shear stress over the rate. The stress fluctuates by
// <S^2> t = 2 kT eta/V, so its relative error after a time t is sqrt(2 kT/(eta V t))/rate, whatever the box. Without mass the noise is
// taken out (`control` of viscosity.h), and eta - eta_0 stands in place of eta under <S^2>.
#include <cstdint>
#include <functional>
#include <string>

#include "odpd/app/calibrated_model.h"
#include "odpd/app/calibration.h"

namespace odpd {

/// What is measured, and in which scene.
struct MeasuredFluid {
  int dimension = 2;
  double density = 4.0;  ///< (1/length^d)
  double mass = 0.0;
  std::shared_ptr<const CalibratedModel> model;
  double shear_rate = 0.0;     ///< fixed; 0: in proportion to 1/friction, see default_shear_rate
  std::int64_t particles = 0;  ///< of the cube
  std::uint64_t seed = 1;

  double box_edge() const;  ///< (particles/density)^(1/d)
  /// The friction only sets the unit of time, so that eta is proportional to it.
  bool linear() const { return mass == 0.0 && shear_rate == 0.0 && model->scales(); }
};

/// Particles of a cube with an edge of 8 (2D) or 6 (3D) cutoffs.
std::int64_t default_particles(int dimension, double density, double cutoff);
/// 9 kT/(gamma r_c^2) (DPD), n kT/eta (SDPD), and with mass at most half a thermal velocity over r_c.
double default_shear_rate(const MeasuredFluid& fluid, double friction);

struct ViscosityRun {
  double gamma = 4.5;
  double shear_rate = 1.0;
  double relative_error = 0.01;  ///< the run ends once the standard error is this small
  std::uint64_t seed = 1;
  int threads = 0;
};

/// Runs until the error is reached, or `stop()` says so. Throws what a Simulation throws.
ViscosityMeasurement measure_viscosity(const MeasuredFluid& fluid, const ViscosityRun& run,
                                       const std::function<bool()>& stop);

}  // namespace odpd
