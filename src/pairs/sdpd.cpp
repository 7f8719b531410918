#include "odpd/pairs/sdpd.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "odpd/core/log.h"
#include "odpd/pairs/calibration.h"
#include "odpd/pairs/density_writer.h"
#include "odpd/pairs/friction.h"

namespace odpd {

double EquationOfState::pressure(double d) const {
  const double x = d / d_0;
  if (exponent == 0.0) return modulus * (x - 1.0) + background;
  return modulus / exponent * (std::pow(x, exponent) - 1.0) + background;
}

// The integral of P/d^2 from d_0 on.
Derivatives EquationOfState::energy(double d) const {
  const double x = d / d_0;
  Derivatives psi;
  double stiffness;  // dP/dd
  if (exponent == 0.0) {
    psi.value = modulus / d_0 * std::log(x) + (modulus - background) * (1.0 / d - 1.0 / d_0);
    stiffness = modulus / d_0;
  } else {
    const double power = std::pow(x, exponent - 1.0);
    psi.value = modulus / (exponent * d_0) * ((power - 1.0) / (exponent - 1.0) + 1.0 / x - 1.0) +
                background * (1.0 / d_0 - 1.0 / d);
    stiffness = modulus / d_0 * power;
  }
  const double p = pressure(d);
  psi.first = p / (d * d);
  psi.second = (stiffness - 2.0 * p / d) / (d * d);
  return psi;
}

SdpdFriction SdpdFriction::of(double eta, double zeta_b, int dimension, bool spin) {
  const double d = dimension;
  if (spin) {
    const double across = 4.0 * (eta * (1.0 + 2.0 / d) - zeta_b);
    return {.A = across, .B = 2.0 * d * zeta_b - across, .spin = true};
  }
  return {.A = eta * (1.0 + 2.0 / d) - zeta_b, .B = (d + 2.0) * (zeta_b + eta * (1.0 - 2.0 / d))};
}

SdpdFriction SdpdFriction::central(double eta, int dimension) {
  return {.A = 0.0, .B = 2.0 * (dimension + 2.0) * eta};
}

SdpdFriction SdpdFriction::classical(double eta, int dimension, bool spin) {
  const double d = dimension,
               both = spin ? 4.0 * (d + 2.0) / (d + 4.0) * eta : 2.0 * (d + 2.0) / (d + 3.0) * eta;
  return {.A = both, .B = both, .spin = spin};
}

double SdpdFriction::eta(int dimension) const {
  return (spin ? 0.25 : 0.5) * A + 0.5 * B / (dimension + 2.0);
}

double SdpdFriction::zeta_b(int dimension) const {
  if (spin) return (A + B) / (2.0 * dimension);
  return B / (dimension + 2.0) - eta(dimension) * (1.0 - 2.0 / dimension);
}

template <int D>
SdpdModel<D>::SdpdModel(const SdpdParameters& p, int species, std::vector<SdpdFriction> friction)
    : p_(p),
      species_(species),
      friction_(std::move(friction)),
      kernel_(p.kernel, D, p.support),
      densities_(kernel_, p.state) {
  require_pair_table(species_, friction_);
  const auto require = [](bool ok, const char* name, double value, const char* range) {
    require_parameter(ok, name, value, range);
  };
  require(p.state.d_0 > 0.0, "density", p.state.d_0, "positive");
  require(p.state.modulus > 0.0, "bulk_modulus", p.state.modulus, "positive");
  require(p.state.exponent == 0.0 || p.state.exponent > 1.0, "tait_exponent", p.state.exponent,
          "larger than 1");
  require(p.kT >= 0.0, "kT", p.kT, "zero or positive");
  for (const SdpdFriction& f : friction_) {
    require(f.A >= 0.0, "A", f.A, "zero or positive");
    require(f.A + f.B >= 0.0, "A + B", f.A + f.B, "zero or positive");
  }
}

// The quintic is made of three pieces.
template <int D>
std::vector<double> SdpdModel<D>::kinks(Site, Site) const {
  const double h = kernel_.support();
  if (kernel_.shape() == SmoothingKernel::Shape::quintic) return {h / 3.0, 2.0 * h / 3.0, h};
  return {h};
}

template <int D>
void SdpdModel<D>::write_edges(const PairList<D>& list, const Box<D>& box,
                               std::span<const Vec<D>> positions, const Particles<D>& particles,
                               PairNetwork<D>& network) const {
  network.transverse = std::any_of(friction_.begin(), friction_.end(),
                                   [](const SdpdFriction& f) { return f.A > 0.0; });
  network.u.fill(0.0);
  network.kT.fill(p_.kT);
  if (network.transverse) {
    network.zeta_perp.each();
  } else {
    network.zeta_perp.fill(0.0);
  }
  const auto weigh = [this](const PairNetwork<D>& n, std::size_t begin, std::size_t end,
                            const WeightColumns& columns) {
    kernel_(std::span(n.r).subspan(begin, end - begin), columns);
  };
  // The pair function, a block at a time.
  const auto fill = [&](PairNetwork<D>& n, std::size_t begin, std::size_t end, double* W_2) {
    std::array<double, density_block> F;
    weigh(n, begin, end, {.W_2 = W_2, .slope = F.data()});
    const std::vector<double>& d = n.densities.d;
    double* const zeta_par = &n.zeta_par[begin];
    double* const zeta_perp = n.transverse ? &n.zeta_perp.each()[begin] : nullptr;
    for (std::size_t k = 0; k < end - begin; ++k) {
      const std::size_t i = index(n.i[begin + k]), j = index(n.j[begin + k]);
      const SdpdFriction& of =
          species_ == 1 ? friction_[0]
                        : friction_[index(particles.species[i] * species_ + particles.species[j])];
      const double slope = F[k] / (d[i] * d[j]);
      zeta_par[k] = (of.A + of.B) * slope;
      if (zeta_perp != nullptr) zeta_perp[k] = of.A * slope;
    }
    std::fill_n(&n.f_c[begin], end - begin, 0.0);
    std::fill_n(&n.k_c.each()[begin], end - begin, 0.0);
  };
  write_density_edges<D>(densities_, weigh, fill, cutoff(), list, box, positions, particles,
                         network);
}

// What is compressed relaxes at the rate K over the longitudinal viscosity, which an explicit step follows up to twice its inverse; accurate
// it is to a fifteenth of that (docs/density-fluids.md). With mass sound has to cross a tenth of a spacing.
template <int D>
std::optional<ReferenceState> SdpdModel<D>::reference_state(double mass) const {
  double longitudinal = std::numeric_limits<double>::infinity();
  for (const SdpdFriction& f : friction_)
    longitudinal = std::min(longitudinal, f.zeta_b(D) + 2.0 * f.eta(D) * (1.0 - 1.0 / D));
  const double n = p_.state.d_0, K = p_.state.modulus;
  const double sound = std::pow(n, -1.0 / D) * std::sqrt(n * mass / K);
  ReferenceState s;
  s.density = n;
  s.spacing = std::pow(n, -1.0 / D);
  s.pressure = p_.state.background;
  s.bulk_modulus = K;
  s.stable_step = std::max(2.0 * longitudinal / K, sound);
  s.accurate_step = std::max(2.0 * longitudinal / (15.0 * K), 0.1 * sound);
  return s;
}

template <int D>
double SdpdModel<D>::lever_radius() const {
  return friction_[0].spin ? 0.5 * std::pow(p_.state.d_0, -1.0 / D) : 0.0;
}

template <int D>
ModelParameters SdpdModel<D>::parameters() const {
  const SdpdFriction& f = friction_[0];
  const EquationOfState& state = p_.state;
  const double spacing = std::pow(state.d_0, -1.0 / D);
  ModelParameters p{"asked for",
                    {{"eta", f.eta(D)},
                     {"zeta_b", f.zeta_b(D)},
                     {"bulk_modulus", state.modulus},
                     {"background_pressure", state.background},
                     {"support", p_.support / spacing},
                     {"h", p_.support},
                     {"A", f.A},
                     {"B", f.B}}};
  if (state.exponent > 0.0) p.values.emplace_back("tait_exponent", state.exponent);
  if (p_.kT > 0.0) {
    p.values.emplace_back("kappa", state.modulus / (state.d_0 * p_.kT));
    p.values.emplace_back("Gamma", state.background / (state.d_0 * p_.kT));
  }
  return p;
}

namespace {

// Parameters of DPD that a user may bring along.
void refuse_dpd_keys(const Config& keys) {
  for (const char* key : {"a", "s_bar", "gamma", "gamma_perp", "sigma", "s", "cutoff",
                          "rattler_friction", "Sc", "tau_P", "alpha", "kappa_inverse"})
    if (keys.gives(key))
      keys.fail(key,
                "is a parameter of DPD; fluid.model = \"sdpd\" is told by what it shall have: eta, "
                "bulk_modulus or sound_speed, and support in place of a cutoff");
  if (names_calibration(keys))
    keys.fail(
        "calibration",
        "is of fluid.model = \"dpd\"; here fluid.eta takes the value that odpd calibrate finds "
        "for the viscosity wanted");
}

SmoothingKernel::Shape read_kernel(const Config& fluid) {
  const std::vector<std::string>& names = smoothing_kernel_names();
  if (fluid.has("kernel") && fluid.text("kernel") == "cubic-spline")
    fluid.fail(
        "kernel",
        fmt::format("the cubic spline lets particles pair, as its slope falls towards r = 0: "
                    "use one of {}",
                    fmt::join(names, ", ")));
  const std::string name = fluid.choice("kernel", names, names.front());
  const auto at = std::find(names.begin(), names.end(), name) - names.begin();
  return static_cast<SmoothingKernel::Shape>(at);
}

// K of [fluid], by itself or by the speed of sound.
double read_modulus(const FluidKeys& keys, double d_0) {
  const Config& fluid = keys.fluid;
  if (fluid.has("bulk_modulus") == fluid.has("sound_speed"))
    fluid.fail("bulk_modulus", "give bulk_modulus or sound_speed, one of the two");
  if (fluid.has("bulk_modulus")) return fluid.positive("bulk_modulus");
  const double c = fluid.positive("sound_speed");
  if (keys.mass == 0.0)
    fluid.fail(
        "sound_speed",
        "there is no sound without mass (K = density mass sound_speed^2): give bulk_modulus");
  return d_0 * keys.mass * c * c;
}

EquationOfState read_state(const FluidKeys& keys, double d_0, double kT) {
  const Config& fluid = keys.fluid;
  EquationOfState state;
  state.d_0 = d_0;
  state.modulus = read_modulus(keys, d_0);
  const double usual = kT > 0.0 ? 100.0 * d_0 * kT : 0.1 * state.modulus;
  state.background = fluid.number("background_pressure", usual);
  if (fluid.choice("equation_of_state", {"linear", "tait"}, "linear") == "tait") {
    state.exponent = fluid.positive("tait_exponent", 7.0);
    if (!(state.exponent > 1.0)) fluid.fail("tait_exponent", "must be larger than 1");
  } else if (fluid.has("tait_exponent")) {
    fluid.fail("tait_exponent", "is of equation_of_state = \"tait\"");
  }
  return state;
}

// eta, and zeta_b or what the form makes of it.
SdpdFriction read_sdpd_friction(const Config& keys, const Config& fluid, int dimension) {
  const bool spin = fluid.has("spin") && fluid.boolean("spin");
  const double eta = keys.has("eta") ? keys.positive("eta") : fluid.positive("eta");
  const std::string form = fluid.choice("form", {"central", "classical"}, "central");
  const Config& of = keys.has("zeta_b") ? keys : fluid;
  if (!of.has("zeta_b"))
    return form == "central" ? SdpdFriction::central(eta, dimension)
                             : SdpdFriction::classical(eta, dimension, spin);
  if (fluid.has("form"))
    of.fail("zeta_b", "follows from form: give zeta_b or fluid.form, never both");
  const double zeta_b = of.non_negative("zeta_b"), most = eta * (1.0 + 2.0 / dimension);
  // At A < 0 friction across the line of centres would feed motion.
  if (zeta_b > most)
    of.fail(
        "zeta_b",
        fmt::format("is more than friction between pairs can give, (1 + 2/d) eta = {:.6g}", most));
  return SdpdFriction::of(eta, zeta_b, dimension, spin);
}

void warn_of(const SdpdParameters& p, const SdpdFriction& f, double spacing) {
  if (f.A > 0.0 && !f.spin)
    log_warning(
        "fluid.model = \"sdpd\" with friction across lines of centres (form = \"classical\" or "
        "zeta_b) "
        "does not keep angular momentum, and its stress is not symmetric: of the shear stresses "
        "only "
        "that of the flow's direction across the gradient is the viscosity's; fluid.spin = true "
        "cures both");
  if (p.support < 2.5 * spacing)
    log_warning(fmt::format(
        "fluid.support = {:.3g} spacings is below 2.5: the viscosity may be far from fluid.eta "
        "(docs/density-fluids.md)",
        p.support / spacing));
  const double thermal = p.state.d_0 * p.kT;
  if (thermal > 0.0 && p.state.background > 300.0 * thermal)
    log_warning(fmt::format(
        "fluid.background_pressure is {:.3g} n kT, above 300: the structure it makes adds to the "
        "viscosity, and towards 1000 the fluid freezes (docs/density-fluids.md)",
        p.state.background / thermal));
  if (p.state.background < 0.0)
    log_warning(
        "fluid.background_pressure is negative: particles pull each other, and the fluid comes "
        "apart "
        "into clumps and voids (docs/density-fluids.md)");
}

}  // namespace

template <int D>
std::shared_ptr<const PairModel<D>> read_sdpd(const FluidKeys& keys) {
  const Config& fluid = keys.fluid;
  refuse_dpd_keys(fluid);
  // All particles fill space alike.
  const double n = keys.density + keys.others;
  if (n == 0.0)
    fluid.fail("density",
               "the equation of state and the support need it, and a start file says it too late: "
               "give fluid.density or fluid.count, in agreement with the file");
  SdpdParameters p;
  p.kT = fluid.non_negative("kT");
  p.kernel = read_kernel(fluid);
  const double d_0 = fluid.positive("reference_density", n);
  const double spacing = std::pow(d_0, -1.0 / D), support = fluid.positive("support", 3.0);
  if (support < 1.0)
    fluid.fail("support",
               "is in spacings density^(-1/d): below 1 a particle has no neighbours, 3 is usual");
  p.support = support * spacing;
  p.state = read_state(keys, d_0, p.kT);
  const SdpdFriction friction = read_sdpd_friction(fluid, fluid, D);
  if (fluid.has("spin") && fluid.boolean("spin") && friction.A == 0.0)
    fluid.fail("spin",
               "particles of the central form have no friction across lines of centres that would "
               "turn them: give fluid.form = \"classical\", or a zeta_b below (1 + 2/d) eta");
  const auto table = pair_table(keys, friction, [&](const Config& pair, const SdpdFriction&) {
    refuse_dpd_keys(pair);
    return read_sdpd_friction(pair, fluid, D);
  });
  warn_of(p, friction, spacing);
  return std::make_shared<const SdpdModel<D>>(p, static_cast<int>(keys.species), table);
}

template class SdpdModel<2>;
template class SdpdModel<3>;
template std::shared_ptr<const PairModel<2>> read_sdpd<2>(const FluidKeys&);
template std::shared_ptr<const PairModel<3>> read_sdpd<3>(const FluidKeys&);

}  // namespace odpd
