#pragma once
// A particle as a pair model sees it.
#include <cstdint>

#include "odpd/particles/particles.h"

namespace odpd {

/// What a model may know of a particle besides its position.
struct Site {
  std::int32_t species = 0;
  double density =
      0.0;  ///< d of pairs/densities.h; 0 where the model has none, and before it is summed
};

template <int D>
Site site_of(const Particles<D>& particles, std::size_t i, double density = 0.0) {
  return {particles.species[i], density};
}

}  // namespace odpd
