#include "odpd/app/fluid_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "odpd/analysis/viscosity.h"
#include "odpd/app/report.h"
#include "odpd/core/index.h"
#include "odpd/pairs/dpd.h"
#include "odpd/pairs/kinetic_theory.h"
#include "odpd/pairs/sdpd_expectation.h"

namespace odpd {

namespace {

using Named = std::vector<std::pair<std::string, double>>;

template <int D>
double density_of(const Scene<D>& scene) {
  // Beside bodies, or of a drop.
  if (const auto reference = scene.model().reference_state(scene.settings().mass))
    return reference->density;
  return static_cast<double>(scene.particles().free_count()) / scene.fluid_volume();
}

template <int D>
Named state_values(const Scene<D>& scene) {
  double range = 0.0;
  for (const PairMoments& p : scene.pair_moments()) range = std::max(range, p.range);
  return {{"density", density_of(scene)},
          {"mass", scene.settings().mass},
          {"kT", scene.largest_kT()},
          {"cutoff", range}};
}

// Of the free particles, by species.
template <int D>
std::vector<double> fractions(const Scene<D>& scene) {
  const Particles<D>& particles = scene.particles();
  std::vector<double> fraction(scene.settings().species.size(), 0.0);
  for (std::size_t i = 0; i < particles.position.size(); ++i)
    if (particles.is_free(i)) fraction[index(particles.species[i])] += 1.0;
  for (double& f : fraction)
    f /= static_cast<double>(std::max<std::int64_t>(1, particles.free_count()));
  return fraction;
}

template <int D>
KineticTheory kinetic_theory_at(const Scene<D>& scene, double density) {
  const double mass = scene.settings().mass;
  return kinetic_theory<D>(scene.pair_moments(), fractions(scene), density, mass,
                           scene.model().reference_state(mass), scene.particles().spin_of_species);
}

template <int D>
KineticTheory kinetic_theory_of(const Scene<D>& scene) {
  return kinetic_theory_at(scene, density_of(scene));
}

Named asked_values(const PhysicalInputs& in) {
  Named values;
  const auto add = [&](const char* name, const std::optional<double>& value) {
    if (value) values.emplace_back(name, *value);
  };
  add("eta", in.eta);
  add("Sc", in.Sc);
  add("tau_P", in.tau_P);
  add("alpha", in.alpha);
  add("kappa_inverse", in.kappa_inverse);
  return values;
}

template <int D>
const SdpdModel<D>* sdpd_fluid(const PairModel<D>& model) {
  return dynamic_cast<const SdpdModel<D>*>(&model);
}

// What an SDPD fluid like this one was measured to have.
template <int D>
std::optional<ExpectedViscosity> expectation(const PairModel<D>& model) {
  const SdpdModel<D>* sdpd = sdpd_fluid(model);
  if (sdpd == nullptr) return std::nullopt;
  return expected_viscosity(sdpd->fluid(), sdpd->friction(), D);
}

template <int D>
std::string expectation_text(const PairModel<D>& model) {
  const SdpdModel<D>* sdpd = sdpd_fluid(model);
  if (sdpd == nullptr) return {};
  const auto e = expectation(model);
  if (!e)
    return fmt::format(
        "  {:<15} eta: no fluid like this one is in the table of docs/density-fluids.md\n",
        "expected");
  const double asked = sdpd->friction().eta(D);
  return fmt::format(
      "  {:<15} eta = {}: {:.3f} of what is asked for, as support = {}, kappa = {}, Gamma = {} has "
      "(docs/density-fluids.md)\n",
      "expected", with_error(e->ratio * asked, e->standard_error * asked), e->ratio, e->support,
      e->kappa, e->Gamma);
}

template <int D>
Named kinetic_values(const Scene<D>& scene, const KineticTheory& k) {
  const auto limit = scene.explicit_step_limit();
  Named values{{"eta", k.eta()},
               {"eta_friction", k.eta_friction},
               {"eta_kinetic", k.eta_kinetic},
               {"kappa_inverse", k.kappa_inverse},
               {"alpha", k.alpha},
               {"Sc", k.Sc},
               {"rho", k.rho},
               {"diffusion", k.diffusion},
               {"tau_P", k.tau_P},
               {"w_0", k.w_0},
               {"l_0", k.l_0},
               {"pressure", k.pressure},
               {"bulk_modulus", k.bulk_modulus},
               {"speed_of_sound", k.speed_of_sound},
               {"energy_per_particle", k.energy},
               {"step_limit", limit.value_or(std::nan(""))}};
  if (k.eta_rotational > 0.0) {
    values.emplace_back("eta_rotational", k.eta_rotational);
    values.emplace_back("spin_relaxation", k.spin_relaxation);
  }
  return values;
}

std::string line(const char* head, const Named& values) {
  constexpr std::size_t per_line = 5;
  std::string out;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (k % per_line == 0) out += fmt::format("{}  {:<15}", k > 0 ? "\n" : "", k > 0 ? "" : head);
    const double value = values[k].second;
    out += " " + values[k].first + " = " +
           (std::isnan(value)   ? "undefined"
            : std::isinf(value) ? "infinite"
                                : fmt::format("{:.6g}", value));
  }
  return out + "\n";
}

JsonObject json_of(const Named& values) {
  JsonObject json;
  for (const auto& [name, value] : values) json.set(name, value);
  return json;
}

struct FlowScale {
  double speed = 0.0, length = 0.0;
};

// Half the difference of two walls' speeds and their distance; or the largest speed that the force gives at this viscosity,
// and the width of its stream; zero for a fluid at rest.
template <int D>
FlowScale flow_scale(const Scene<D>& scene, double eta) {
  using Kind = ViscosityScene::Kind;
  const SceneSettings<D>& s = scene.settings();
  const ViscosityScene v = viscosity_scene(scene);
  if (v.kind == Kind::images)
    return {0.5 * std::abs(s.box.shear->rate) * s.box.size[v.axis], s.box.size[v.axis]};
  const double width = v.to - v.from + 2.0 * scene.model().cutoff();
  if (v.kind == Kind::sheared) {
    const auto wall = [&](bool high) {
      return s.walls[index(s.wall_at(v.axis, high))].velocity[v.component];
    };
    return {0.5 * std::abs(wall(true) - wall(false)), width};
  }
  Vec<D> middle{};
  middle[v.axis] = 0.5 * (v.from + v.to);
  if (v.kind == Kind::parabola)
    return {
        density_of(scene) * std::abs(s.force_at(middle)[v.component]) * width * width / (8.0 * eta),
        width};
  if (v.kind != Kind::sine) return {};
  const double length = s.box.size[v.axis] / static_cast<double>(s.force_wave.number);
  return {density_of(scene) * std::abs(s.body_force[v.component]) *
              std::pow(length / (2.0 * std::numbers::pi), 2) / eta,
          length};
}

// Re, M, Sc (Phan-Thien et al. 2016, eq. 1), Pe = U L/D, and eta U/(L n dp/dn), which takes the place of the Mach number at
// mass 0; with what the run measured, and the equation of state of kinetic theory. Empty without a measured viscosity.
template <int D>
Named group_values(const Scene<D>& scene, const KineticTheory& k, const Results& results) {
  const Scalar* eta = measured_viscosity(results);
  if (eta == nullptr || !(eta->mean > 0.0)) return {};
  const FlowScale flow = flow_scale(scene, eta->mean);
  const Scalar* diffusion = results.find("diffusion");
  const bool diffuses = diffusion != nullptr && diffusion->mean > 0.0;
  Named values;
  if (diffuses)
    values.emplace_back("Sc", k.rho > 0.0 ? eta->mean / (k.rho * diffusion->mean)
                                          : std::numeric_limits<double>::infinity());
  if (flow.speed == 0.0) return values;
  values.emplace_back("U", flow.speed);
  values.emplace_back("L", flow.length);
  values.emplace_back("Re", k.rho * flow.speed * flow.length / eta->mean);
  values.emplace_back("Mach", k.rho > 0.0 ? flow.speed / k.speed_of_sound : 0.0);
  if (diffuses) values.emplace_back("Pe", flow.speed * flow.length / diffusion->mean);
  values.emplace_back("viscous_compression",
                      eta->mean * flow.speed / (flow.length * k.bulk_modulus));
  return values;
}

// What the numbers above leave out, for this fluid.
template <int D>
std::string limits(const Scene<D>& scene) {
  const SceneSettings<D>& settings = scene.settings();
  std::string out =
      "  Kinetic theory is a guide: it knows no structure and lets particles follow the mean flow. "
      "At small mass the\n  viscosity of friction alone is at most eta_friction, often a fraction "
      "of it, and repulsion adds its share:\n  measure it (docs/physical-inputs.md)\n";
  if (settings.species.size() > 1)
    out += "  Of several species it takes the means over pairs of particles at random\n";
  return out;
}

}  // namespace

const Scalar* measured_viscosity(const Results& results) {
  if (const Scalar* chosen = results.find("viscosity")) return chosen;
  for (const Scalar& scalar : results.scalars)
    if (scalar.name.ends_with(".viscosity") && !std::isnan(scalar.mean)) return &scalar;
  return nullptr;
}

template <int D>
KnownViscosity known_viscosity(const Scene<D>& scene, double density) {
  const PairModel<D>& model = *scene.settings().model;
  if (const DpdFluid* dpd = dpd_fluid(model); dpd != nullptr && dpd->calibration) {
    const Calibration& c = *dpd->calibration;
    return {c.eta * std::pow(density / c.density, 2), "calibration"};
  }
  if (const SdpdModel<D>* sdpd = sdpd_fluid(model)) {
    const double asked = sdpd->friction().eta(D);
    if (const auto e = expectation(model)) return {e->ratio * asked, "expected"};
    return {asked, "asked for"};
  }
  return {kinetic_theory_at(scene, density).eta(), "kinetic theory"};
}

template <int D>
std::string fluid_text(const Scene<D>& scene, const Results& results) {
  const PairModel<D>& model = *scene.settings().model;
  const KineticTheory k = kinetic_theory_of(scene);
  std::string out = "Fluid\n" + line("state", state_values(scene));
  const ModelParameters parameters = model.parameters();
  if (!parameters.values.empty()) out += line(parameters.heading.c_str(), parameters.values);
  const DpdFluid* dpd = dpd_fluid(model);
  if (dpd != nullptr && dpd->asked.any()) out += line("asked for", asked_values(dpd->asked));
  if (dpd != nullptr && dpd->calibration) {
    const Calibration& c = *dpd->calibration;
    out += fmt::format("  {:<15} gamma = {}, measured to give eta = {} ({})\n", "calibrated",
                       with_error(c.fluid.gamma, c.gamma_error), with_error(c.eta, c.eta_error),
                       c.file);
  }
  out += line("kinetic theory", kinetic_values(scene, k));
  out += expectation_text(model);
  const Scalar* measured = measured_viscosity(results);
  out += fmt::format(
      "  {:<15} {}\n", "measured",
      measured ? fmt::format("eta = {} ({})", with_error(measured->mean, measured->standard_error),
                             measured->name)
               : "eta: not in this run");
  if (const Named groups = group_values(scene, k, results); !groups.empty())
    out += line("groups", groups);
  return out + limits(scene);
}

template <int D>
JsonObject fluid_json(const Scene<D>& scene, const Results& results) {
  const PairModel<D>& model = *scene.settings().model;
  const KineticTheory k = kinetic_theory_of(scene);
  JsonObject json;
  json.set("state", json_of(state_values(scene)));
  json.set(model.name(), json_of(model.parameters().values));
  if (const DpdFluid* dpd = dpd_fluid(model)) {
    json.set("asked_for", json_of(asked_values(dpd->asked)));
    if (const auto& c = dpd->calibration)
      json.set("calibration", JsonObject()
                                  .set("file", c->file)
                                  .set("gamma", c->fluid.gamma)
                                  .set("gamma_stderr", c->gamma_error)
                                  .set("eta", c->eta)
                                  .set("eta_stderr", c->eta_error));
  }
  if (const auto e = expectation(model)) {
    const double asked = sdpd_fluid(model)->friction().eta(D);
    json.set("viscosity_expected", JsonObject()
                                       .set("mean", e->ratio * asked)
                                       .set("stderr", e->standard_error * asked)
                                       .set("support", e->support)
                                       .set("kappa", e->kappa)
                                       .set("Gamma", e->Gamma));
  }
  json.set("kinetic_theory", json_of(kinetic_values(scene, k)));
  json.set("groups", json_of(group_values(scene, k, results)));
  const Scalar* measured = measured_viscosity(results);
  if (!measured) return json.set("viscosity_measured", std::numeric_limits<double>::quiet_NaN());
  return json.set("viscosity_measured", JsonObject()
                                            .set("observable", measured->name)
                                            .set("mean", measured->mean)
                                            .set("stderr", measured->standard_error));
}

template KnownViscosity known_viscosity<2>(const Scene<2>&, double);
template KnownViscosity known_viscosity<3>(const Scene<3>&, double);
template std::string fluid_text<2>(const Scene<2>&, const Results&);
template std::string fluid_text<3>(const Scene<3>&, const Results&);
template JsonObject fluid_json<2>(const Scene<2>&, const Results&);
template JsonObject fluid_json<3>(const Scene<3>&, const Results&);

}  // namespace odpd
