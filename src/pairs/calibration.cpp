#include "odpd/pairs/calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace odpd {

bool names_calibration(const Config& fluid) {
  return fluid.has("calibration") && !fluid.text("calibration").empty();
}

double calibrated_friction(const Config& fluid, const std::optional<Calibration>& calibration,
                           const std::optional<double>& eta, const FluidState& here) {
  if (!eta)
    fluid.fail("calibration", "is for a fluid given by its viscosity: give eta, or leave it out");
  if (!calibration)
    fluid.fail("calibration",
               "the file was not read: give read_scene_settings what read_calibration returns");
  const Calibration& c = *calibration;
  if (fluid.has("alpha"))
    fluid.fail("alpha",
               "sets a by gamma, which fluid.calibration sets by measurements at one a: give a "
               "instead");
  const auto same = [&](const char* key, double measured, double value) {
    // A density may come from a count and a volume.
    if (std::abs(measured - value) <= 1e-9 * std::max(std::abs(measured), std::abs(value))) return;
    // Of the table rattler_friction its two numbers.
    const std::string path(key);
    fluid.fail(
        path.substr(0, path.find('.')),
        fmt::format("{} was measured for {} = {}, this fluid has {}: measure again with odpd "
                    "calibrate CASE, and name its file",
                    c.file, key, measured, value));
  };
  if (c.dimension != here.dimension)
    fluid.fail("calibration", fmt::format("{} was measured with dimension = {}, this case has {}: "
                                          "measure again with odpd calibrate CASE, and name its "
                                          "file",
                                          c.file, c.dimension, here.dimension));
  same("density", c.density, here.density);
  same("mass", c.mass, here.mass);
  same("kT", c.fluid.kT, here.p.kT);
  same("cutoff", c.fluid.cutoff, here.p.cutoff);
  same("a", c.fluid.a, here.p.a);
  same("s_bar", c.fluid.s_bar, here.p.s_bar);
  same("s", c.fluid.s, here.p.s);
  same("rattler_friction.gamma", c.fluid.gamma_far, here.p.gamma_far);
  if (here.p.gamma_far > 0.0)
    same("rattler_friction.cutoff", c.fluid.cutoff_far, here.p.cutoff_far);
  same("eta", c.eta, *eta);
  return c.fluid.gamma;
}

}  // namespace odpd
