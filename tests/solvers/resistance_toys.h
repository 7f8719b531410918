#pragma once
// Resistance operators of random fluids, for the tests of what needs more than a System.
#include <cmath>

#include "odpd/operator/resistance.h"
#include "support/network.h"

namespace toys {

enum class Ends { periodic, walls, open };

/// `count` particles at number density 8 (a random one of 4 has rattlers). Walls: x is bounded, and the particles in the
/// first and the last unit of it are at rest. s: exponent of w_D.
template <int D>
struct RandomFluid {
  explicit RandomFluid(std::size_t count, Ends ends = Ends::periodic, double shift = 0.0,
                       double gamma_perp = 0.0, std::uint64_t seed = 3, double s = 0.5)
      : fluid(std::pow(static_cast<double>(count) / 8.0, 1.0 / D), ends != Ends::open),
        resistance(fluid.box) {
    if (ends == Ends::walls) fluid.box.periodic[0] = false;
    const double length = fluid.box.size[0];
    for (const auto& r : support::random_points<D>({}, fluid.box.size, count, seed)) {
      const bool at_rest = ends == Ends::walls && (r[0] < 1.0 || r[0] > length - 1.0);
      fluid.particles.add(r, 0, at_rest ? odpd::Group::wall(0) : odpd::Group());
    }
    resistance = odpd::Resistance<D>(fluid.box);
    odpd::DpdParameters p;
    p.gamma_perp = gamma_perp;
    p.s = s;
    fluid.connect(odpd::DpdModel<D>(1, {p}));
    rebuild(shift);
  }
  void rebuild(double shift, double stiffness_time = 0.0) {
    resistance.rebuild(fluid.network, odpd::DofMap<D>(fluid.particles), fluid.particles,
                       fluid.particles.position, shift, stiffness_time);
  }

  support::Fluid<D> fluid;
  odpd::Resistance<D> resistance;
};

}  // namespace toys
