#include "odpd/pairs/dpd_keys.h"

#include <fmt/format.h>

#include "odpd/pairs/dpd.h"
#include "odpd/pairs/physical_keys.h"

namespace odpd {

namespace {

void set_friction(const FrictionParameters& f, DpdParameters& p) {
  p.gamma = f.gamma;
  p.gamma_perp = f.gamma_perp;
  p.s = f.s;
  p.cutoff = f.cutoff;
  p.kT = f.kT;
  p.gamma_far = f.gamma_far;
  p.cutoff_far = f.cutoff_far;
  p.core = f.core;
}

// Keys of [fluid] (`whole`) or one pair of species, `base` where they are absent.
DpdParameters read_parameters(const Config& keys, const DpdParameters& base, bool whole) {
  DpdParameters p = base;
  p.a = whole ? keys.non_negative("a") : keys.non_negative("a", base.a);
  p.s_bar = keys.positive("s_bar", base.s_bar);
  set_friction(read_friction(keys, base.friction(), whole), p);
  return p;
}

template <int D>
DpdFluid read_dpd_fluid(const FluidKeys& keys) {
  const Config& fluid = keys.fluid;
  DpdFluid dpd;
  dpd.asked = read_physical_inputs(fluid);
  if (dpd.asked.any()) {
    if (keys.density == 0.0)
      fluid.fail("eta",
                 "physical inputs need the density, which a start file says too late: give "
                 "fluid.density or fluid.count, in agreement with the file");
    dpd.p = read_physical_fluid<D>(fluid, dpd.asked, keys.density, keys.mass);
    FrictionParameters friction = dpd.p.friction();
    read_far_friction(fluid, friction);
    set_friction(friction, dpd.p);
  } else {
    dpd.p = read_parameters(fluid, DpdParameters{}, true);
  }
  if (names_calibration(fluid)) {
    dpd.p.gamma = calibrated_friction(fluid, keys.calibration, dpd.asked.eta,
                                      {D, keys.density, keys.mass, dpd.p});
    dpd.calibration = keys.calibration;
  }
  return dpd;
}

}  // namespace

template <int D>
std::shared_ptr<const PairModel<D>> read_dpd(const FluidKeys& keys) {
  const DpdFluid fluid = read_dpd_fluid<D>(keys);
  const auto table = pair_table(keys, fluid.p, [](const Config& pair, const DpdParameters& base) {
    return read_parameters(pair, base, false);
  });
  return std::make_shared<const DpdModel<D>>(static_cast<int>(keys.species), table, fluid);
}

template std::shared_ptr<const PairModel<2>> read_dpd<2>(const FluidKeys&);
template std::shared_ptr<const PairModel<3>> read_dpd<3>(const FluidKeys&);

}  // namespace odpd
