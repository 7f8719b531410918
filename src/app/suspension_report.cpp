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

// Of `count` bodies, or molecules, of `sites` particles together.
template <int D, class Body>
SuspensionKind kind_of(const SceneSettings<D>& s, const Body& b, std::int64_t count,
                       std::int64_t sites, double particles, double kT) {
  const auto bodies = static_cast<double>(count);
  const double volume = s.fluid_volume();
  SuspensionKind kind{.name = b.name,
                      .bodies = count,
                      .number_fraction = static_cast<double>(sites) / particles,
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
  const auto of_known_size = [](const MoleculeSettings<D>& m) {
    return m.excluded_volume + m.hydrodynamic_radius > 0.0;
  };
  double strangers = 0.0;  // beads of molecules of which nothing is known
  for (const MoleculeSettings<D>& m : s.molecules) {
    const auto beads = static_cast<double>(m.molecules() * m.beads());
    (of_known_size(m) ? sites : strangers) += beads;
    excluded += m.excluded_volume;
    radii += m.hydrodynamic_radius;
  }
  if (!(excluded + radii > 0.0)) return {};
  const double free = static_cast<double>(particles.free_count() - s.molecule_beads()) + strangers;
  Suspension all;
  all.together = {.name = "together",
                  .exclusion_fraction = 0.0,
                  .hydrodynamic_fraction = 0.0,
                  .peclet_of_unit_eta = {}};
  const double kT = scene.largest_kT();
  for (const BodySettings<D>& b : s.bodies)
    all.kinds.push_back(kind_of(s, b, b.bodies(), b.particles(), free + sites, kT));
  for (const MoleculeSettings<D>& m : s.molecules)
    if (of_known_size(m))
      all.kinds.push_back(
          kind_of(s, m, m.molecules(), m.molecules() * m.beads(), free + sites, kT));
  for (const SuspensionKind& kind : all.kinds) {
    SuspensionKind& t = all.together;
    t.bodies += kind.bodies;
    t.number_fraction += kind.number_fraction;
    t.exclusion_fraction = sum(t.exclusion_fraction, kind.exclusion_fraction);
    t.hydrodynamic_fraction = sum(t.hydrodynamic_fraction, kind.hydrodynamic_fraction);
  }
  // What other molecules take from the fluid nobody knows.
  if (all.together.exclusion_fraction && strangers == 0.0)
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
