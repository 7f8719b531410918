#include "odpd/app/suspension_report.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace odpd {

namespace {

// 6 pi a^3, in 2D 4 pi a^2.
template <int D>
double drag_times_square(double a) {
  return 2.0 * D * std::numbers::pi * std::pow(a, D);
}

template <int D>
SuspensionKind kind_of(const SceneSettings<D>& s, const BodySettings<D>& b, double particles,
                       double kT) {
  const auto bodies = static_cast<double>(b.bodies());
  const double volume = s.fluid_volume();
  SuspensionKind kind{.name = b.name,
                      .bodies = b.bodies(),
                      .number_fraction = static_cast<double>(b.particles()) / particles,
                      .exclusion_fraction = {},
                      .hydrodynamic_fraction = {},
                      .peclet_of_unit_eta = {}};
  if (b.excluded_volume > 0.0) kind.exclusion_fraction = bodies * b.excluded_volume / volume;
  if (const double a = b.hydrodynamic_radius; a > 0.0) {
    kind.hydrodynamic_fraction = bodies * unit_ball_volume<D> * std::pow(a, D) / volume;
    if (s.box.shear && kT > 0.0)
      kind.peclet_of_unit_eta = drag_times_square<D>(a) * std::abs(s.box.shear->rate) / kT;
  }
  return kind;
}

std::optional<double> sum(const std::optional<double>& a, const std::optional<double>& b) {
  if (!a || !b) return {};
  return *a + *b;
}

std::string fractions_text(const SuspensionKind& kind) {
  std::string out = fmt::format("  {:<15} {} bodies: number fraction = {:.5g}", kind.name,
                                kind.bodies, kind.number_fraction);
  if (kind.exclusion_fraction)
    out += fmt::format(", exclusion fraction = {:.5g}", *kind.exclusion_fraction);
  if (kind.hydrodynamic_fraction)
    out += fmt::format(", hydrodynamic fraction = {:.5g}", *kind.hydrodynamic_fraction);
  return out + "\n";
}

JsonObject json_of_kind(const SuspensionKind& kind) {
  JsonObject json;
  json.set("name", kind.name)
      .set("bodies", kind.bodies)
      .set("number_fraction", kind.number_fraction);
  if (kind.exclusion_fraction) json.set("exclusion_fraction", *kind.exclusion_fraction);
  if (kind.hydrodynamic_fraction) json.set("hydrodynamic_fraction", *kind.hydrodynamic_fraction);
  return json;
}

}  // namespace

template <int D>
std::optional<Suspension> suspension_of(const Scene<D>& scene) {
  const SceneSettings<D>& s = scene.settings();
  const Particles<D>& particles = scene.particles();
  double sites = 0.0, excluded = 0.0, radii = 0.0;
  for (const BodySettings<D>& b : s.bodies) {
    sites += static_cast<double>(b.particles());
    excluded += b.excluded_volume;
    radii += b.hydrodynamic_radius;
  }
  if (!(excluded + radii > 0.0)) return {};
  const auto free = static_cast<double>(particles.free_count());
  Suspension all;
  all.together = {.name = "together",
                  .exclusion_fraction = 0.0,
                  .hydrodynamic_fraction = 0.0,
                  .peclet_of_unit_eta = {}};
  for (const BodySettings<D>& b : s.bodies) {
    all.kinds.push_back(kind_of(s, b, free + sites, scene.largest_kT()));
    const SuspensionKind& kind = all.kinds.back();
    SuspensionKind& t = all.together;
    t.bodies += kind.bodies;
    t.number_fraction += kind.number_fraction;
    t.exclusion_fraction = sum(t.exclusion_fraction, kind.exclusion_fraction);
    t.hydrodynamic_fraction = sum(t.hydrodynamic_fraction, kind.hydrodynamic_fraction);
  }
  // What molecules take from the fluid nobody knows.
  if (all.together.exclusion_fraction && s.molecules.empty())
    all.bulk_density = free / (s.fluid_volume() * (1.0 - *all.together.exclusion_fraction));
  all.fluid = known_viscosity(scene, all.bulk_density.value_or(free / s.fluid_volume()));
  return all;
}

template <int D>
std::string suspension_text(const Scene<D>& scene, const Results& results) {
  const auto all = suspension_of(scene);
  if (!all) return {};
  std::string out = "Suspension\n";
  for (const SuspensionKind& kind : all->kinds) out += fractions_text(kind);
  if (all->kinds.size() > 1) out += fractions_text(all->together);
  if (all->bulk_density)
    out += fmt::format(
        "  {:<15} density = {:.6g} between the bodies: compare with a pure fluid of that density\n",
        "fluid", *all->bulk_density);
  const Scalar* measured = measured_viscosity(results);
  for (const SuspensionKind& kind : all->kinds) {
    if (!kind.peclet_of_unit_eta) continue;
    out += fmt::format("  {:<15} {}: Pe = {:.5g} with the fluid's eta = {:.5g} ({})",
                       "Peclet number", kind.name, *kind.peclet_of_unit_eta * all->fluid.eta,
                       all->fluid.eta, all->fluid.source);
    if (measured != nullptr)
      out += fmt::format(", {:.5g} with the suspension's ({})",
                         *kind.peclet_of_unit_eta * measured->mean, measured->name);
    out += "\n";
  }
  return out;
}

template <int D>
std::optional<JsonObject> suspension_json(const Scene<D>& scene, const Results& results) {
  const auto all = suspension_of(scene);
  if (!all) return {};
  const Scalar* measured = measured_viscosity(results);
  bool peclet = false;
  std::vector<JsonObject> kinds;
  for (const SuspensionKind& kind : all->kinds) {
    JsonObject json = json_of_kind(kind);
    if (kind.peclet_of_unit_eta) {
      peclet = true;
      json.set("peclet", *kind.peclet_of_unit_eta * all->fluid.eta);
      if (measured != nullptr)
        json.set("peclet_of_measured_viscosity", *kind.peclet_of_unit_eta * measured->mean);
    }
    kinds.push_back(json);
  }
  JsonObject json;
  json.set("bodies", kinds).set("together", json_of_kind(all->together));
  if (all->bulk_density) json.set("bulk_density", *all->bulk_density);
  if (peclet) json.set("eta", all->fluid.eta).set("eta_source", all->fluid.source);
  return json;
}

#define ODPD_INSTANTIATE(D)                                                 \
  template std::optional<Suspension> suspension_of<D>(const Scene<D>&);     \
  template std::string suspension_text<D>(const Scene<D>&, const Results&); \
  template std::optional<JsonObject> suspension_json<D>(const Scene<D>&, const Results&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
