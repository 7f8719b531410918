#include "odpd/pairs/friction.h"

#include <fmt/format.h>

#include "odpd/core/error.h"

namespace odpd {

void require_parameter(bool ok, const char* name, double value, const char* range) {
  if (!ok)
    throw ConfigError(
        fmt::format("parameter {} = {} of a pair model must be {}", name, value, range));
}

void validate(const FrictionParameters& p) {
  require_parameter(p.gamma >= 0.0, "gamma", p.gamma, "zero or positive");
  require_parameter(p.gamma_perp >= 0.0, "gamma_perp", p.gamma_perp, "zero or positive");
  require_parameter(p.s >= 0.0, "s", p.s, "zero or positive");
  require_parameter(p.cutoff > 0.0, "cutoff", p.cutoff, "positive");
  require_parameter(p.core >= 0.0 && p.core < p.cutoff, "core", p.core,
                    "zero or positive, and smaller than the cutoff");
  require_parameter(p.kT >= 0.0, "kT", p.kT, "zero or positive");
  require_parameter(p.gamma_far >= 0.0, "gamma_far", p.gamma_far, "zero or positive");
  require_parameter(p.gamma_far == 0.0 || p.cutoff_far > p.cutoff, "cutoff_far", p.cutoff_far,
                    "larger than the cutoff, to reach particles without neighbours");
}

FrictionParameters read_friction(const Config& keys, const FrictionParameters& base, bool whole) {
  FrictionParameters p = base;
  if (whole) p.kT = keys.non_negative("kT");
  p.cutoff = keys.positive("cutoff", base.cutoff);
  if (!whole) p.core = keys.non_negative("core", base.core);
  if (p.core >= p.cutoff)
    keys.fail("core",
              fmt::format("must be smaller than the cutoff of the pair, {}: force and friction "
                          "go to zero from the core to there",
                          p.cutoff));
  p.s = keys.non_negative("s", base.s);
  p.gamma_perp = keys.non_negative("gamma_perp", base.gamma_perp);
  if (keys.has("gamma") && keys.has("sigma"))
    keys.fail("sigma", "give gamma or sigma, never both: sigma^2 = 2 gamma kT");
  if (keys.has("sigma")) {
    const double sigma = keys.positive("sigma");
    if (p.kT == 0.0)
      keys.fail("sigma", "at kT = 0 there is no noise to set the friction by: give gamma");
    p.gamma = sigma * sigma / (2.0 * p.kT);
  } else if (whole || keys.has("gamma")) {
    p.gamma = keys.positive("gamma");
  }
  if (whole) read_far_friction(keys, p);
  return p;
}

void read_far_friction(const Config& fluid, FrictionParameters& p) {
  if (!fluid.has("rattler_friction")) return;
  const Config far = fluid.table("rattler_friction");
  p.gamma_far = far.positive("gamma");
  p.cutoff_far = far.positive("cutoff");
  if (p.cutoff_far <= p.cutoff)
    far.fail(
        "cutoff",
        fmt::format("must be larger than fluid.cutoff = {}, to reach particles without neighbours",
                    p.cutoff));
}

const std::vector<std::string>& friction_keys() {
  static const std::vector<std::string> keys{"gamma", "gamma_perp", "s", "rattler_friction"};
  return keys;
}

}  // namespace odpd
