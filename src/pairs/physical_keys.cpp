#include "odpd/pairs/physical_keys.h"

#include <fmt/format.h>

#include <initializer_list>

namespace odpd {

namespace {

std::optional<double> read_optional(const Config& fluid, const std::string& key) {
  if (!fluid.has(key)) return std::nullopt;
  return fluid.positive(key);
}

// Each property is given once: by its physical input or by the DPD parameters it sets.
void refuse_with(const Config& fluid, const char* physical,
                 std::initializer_list<const char*> parameters) {
  for (const char* key : parameters)
    if (fluid.has(physical) && fluid.has(key))
      fluid.fail(
          key, fmt::format("follows from {}: give {} or {}, never both", physical, physical, key));
}

}  // namespace

PhysicalInputs read_physical_inputs(const Config& fluid) {
  PhysicalInputs in;
  in.eta = read_optional(fluid, "eta");
  in.Sc = read_optional(fluid, "Sc");
  in.tau_P = read_optional(fluid, "tau_P");
  in.alpha = read_optional(fluid, "alpha");
  in.kappa_inverse = read_optional(fluid, "kappa_inverse");
  refuse_with(fluid, "eta", {"gamma", "sigma"});
  refuse_with(fluid, "Sc", {"s"});
  refuse_with(fluid, "tau_P", {"s", "Sc"});
  refuse_with(fluid, "alpha", {"a"});
  if (in.any() && fluid.has("gamma_perp"))
    fluid.fail("gamma_perp",
               "the formulas of physical inputs count friction along the line of centres alone: "
               "leave it out, or give gamma and the other DPD parameters instead");
  if (!in.kappa_inverse) return in;
  if (in.alpha) {
    refuse_with(fluid, "kappa_inverse", {"s_bar"});
  } else if (fluid.has("a") == fluid.has("s_bar")) {
    fluid.fail("kappa_inverse",
               "sets a for a given s_bar, or s_bar for a given a: give one of the two, or alpha "
               "(which needs mass > 0) to set both");
  }
  in.keep_s_bar = !in.alpha && fluid.has("s_bar");
  return in;
}

template <int D>
DpdParameters read_physical_fluid(const Config& fluid, const PhysicalInputs& in, double density,
                                  double mass) {
  DpdParameters base;
  base.kT = fluid.non_negative("kT");
  base.cutoff = fluid.positive("cutoff", base.cutoff);
  if (!in.Sc && !in.tau_P) base.s = fluid.non_negative("s", base.s);
  if (!in.alpha && !in.keep_s_bar) base.a = fluid.non_negative("a");
  if (!in.kappa_inverse || in.keep_s_bar) base.s_bar = fluid.positive("s_bar", base.s_bar);
  try {
    return dpd_parameters<D>(in, base, density, mass);
  } catch (const PhysicalInputError& e) {
    fluid.fail(e.key(), e.message());
  }
}

void refuse_physical_inputs(const Config& fluid, const std::string& model) {
  for (const char* key : {"eta", "Sc", "tau_P", "alpha", "kappa_inverse", "calibration"})
    if (fluid.gives(key))
      fluid.fail(key,
                 fmt::format("physical inputs and calibrations are of fluid.model = \"dpd\", this "
                             "fluid's is \"{}\": give the parameters of that model instead",
                             model));
}

template DpdParameters read_physical_fluid<2>(const Config&, const PhysicalInputs&, double, double);
template DpdParameters read_physical_fluid<3>(const Config&, const PhysicalInputs&, double, double);

}  // namespace odpd
