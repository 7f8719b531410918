#pragma once
// A suspension by its numbers. Of N_b bodies of a kind, with p sites each, among N_s particles of fluid in a volume V between the walls:
//
//   number fraction         N_b p/N                  sites over all N particles but those of walls
//   exclusion fraction      N_b v_ex/V               `excluded_volume` of its [[body]], or [[molecule]]
//   hydrodynamic fraction   N_b (4 pi/3) a^3/V       in 2D N_b pi a^2/V; `hydrodynamic_radius`
//   Peclet number           6 pi eta a^3 rate/kT     in 2D 4 pi eta a^2 rate/kT; under [shear]
//   bulk density            N_s/(V - sum N_b v_ex)   of the fluid between the bodies
//
// The Peclet number is a^2 rate/D of Stokes and Einstein; in 2D, where a lone disk has no D, a definition. Its eta is that of the fluid
// without bodies, at the bulk density where that is known. What a case does not give is left out.
#include <optional>
#include <string>
#include <vector>

#include "odpd/analysis/results.h"
#include "odpd/app/fluid_report.h"

namespace odpd {

struct SuspensionKind {
  std::string name;
  std::int64_t bodies = 0;
  double number_fraction = 0.0;
  std::optional<double> exclusion_fraction, hydrodynamic_fraction;
  /// Of eta = 1, under [shear].
  std::optional<double> peclet_of_unit_eta;
};

struct Suspension {
  std::vector<SuspensionKind> kinds;
  SuspensionKind together;  ///< sums; a fraction where all kinds have it, no Peclet number
  std::optional<double> bulk_density;
  KnownViscosity fluid;
};

/// Nothing where no [[body]] and no [[molecule]] gives a hydrodynamic radius or an excluded volume.
template <int D>
std::optional<Suspension> suspension_of(const Scene<D>& scene);

/// Lines of the dry run and the report; "" where there is none.
template <int D>
std::string suspension_text(const Scene<D>& scene, const Results& results);
/// "suspension" of summary.json: "bodies" (one object for each kind), "together", "bulk_density", and with Peclet numbers "eta" and
/// "eta_source".
template <int D>
std::optional<JsonObject> suspension_json(const Scene<D>& scene, const Results& results);

}  // namespace odpd
