#pragma once
// The scenes of `odpd calibrate --radius`: one body of a case, or one colloid that is a single particle ([[molecule]] with shape = "particle"), in a
// periodic cube of its fluid, and the fluid alone, at rest and at equilibrium.
// Both are sampled by observers that see no noise (analysis/mobility.h, analysis/high_frequency_viscosity.h).
#include <functional>
#include <string>

#include "odpd/app/case.h"
#include "odpd/app/hydrodynamic_radius.h"
#include "odpd/scene/scene.h"

namespace odpd {

/// What is measured, and with what.
struct MeasuredBody {
  int dimension = 3;
  std::string entry = "body";  ///< or "molecule", of one particle
  std::string name;            ///< of it
  std::string own_species;     ///< of its particles
  // As TOML:
  std::string fluid;    ///< lines of [fluid], but for what says how many particles there are
  std::string species;  ///< [[species]] and [[pair]]
  std::string body;     ///< lines of its entry, but for its place
  bool fills_space =
      false;  ///< friction goes by densities, with those of the body's particles (SDPD)
  std::int64_t sites = 0;  ///< particles of the body
  /// Its outermost ones from its centre (length). Of a single particle, where a body of its range would have them: half a cutoff of the fluid
  /// within where its friction ends.
  double reach = 0.0;
  bool round = true;     ///< a disk or ball, or like one
  double density = 4.0;  ///< n that the fluid is to have far from the body (1/length^d)
  double cutoff = 1.0;   ///< of the fluid's pairs (length)
  double dt = 0.01;
  std::uint64_t seed = 1;

  /// Of the density, in the viscosity of the fluid near it.
  double viscosity_exponent() const { return fills_space ? 0.0 : 2.0; }
  /// Edges of three cubes, the smallest one first (length): at least 4, 5 and 6 (2D: 4, 6 and 8) times a cutoff/2 more than the reach, about, and
  /// whole multiples of 1.5 cutoffs, as the grid of the pressure (analysis/frozen_pressure.h) then is as fine in all of them.
  std::vector<double> default_edges() const;
  /// Farther from the centre than this the fluid is taken for undisturbed (length): 3/2 cutoffs beyond the reach, or half an edge.
  double far(double edge) const;
};

/// Takes the body or single particle `name` ("": the only free one) from a case that a scene was built from. Throws ConfigError for what cannot be measured.
template <int D>
MeasuredBody measured_body(const Config& config, const Scene<D>& scene, double dt,
                           const std::string& name);

struct PureFluid {
  Measured density;  ///< without error
  Measured eta;      ///< by the same estimator
  std::int64_t particles = 0, samples = 0;
};

/// Until `enough(fluid)` or `stop()`. The box has an edge of 8 (2D) or 6 (3D) cutoffs.
PureFluid measure_pure_fluid(const MeasuredBody& body, int threads,
                             const std::function<bool(const PureFluid&)>& enough,
                             const std::function<bool()>& stop);

/// The same of one body in a cube of this edge. `excluded`: v_ex so far, which says how many particles of fluid there are.
BodyInCell measure_body(const MeasuredBody& body, double edge, double excluded, int threads,
                        const std::function<bool(const BodyInCell&)>& enough,
                        const std::function<bool()>& stop);

}  // namespace odpd
