#pragma once
// A part of the space between the walls, in which the fluid starts: a block from corner to corner, or the ball of a radius about its middle.
#include "odpd/core/config.h"
#include "odpd/core/vec.h"

namespace odpd {

template <int D>
struct StartRegion {
  Vec<D> from{}, to{};  ///< corners
  double radius = 0.0;  ///< of the ball about the middle between them; 0: the block

  bool holds(const Vec<D>& r) const {
    return radius == 0.0 || norm(r - 0.5 * (from + to)) < radius;
  }
  double volume() const;
};

/// The keys `from` and `to`, or `centre` and `radius`, of a table. Throws ConfigError where they make no region.
template <int D>
StartRegion<D> read_start_region(const Config& region);

/// Throws ConfigError where the region of these keys does not lie between `low` and `high`, the ends of the space between the walls.
template <int D>
void check_start_region(const Config& keys, const StartRegion<D>& region, const Vec<D>& low,
                        const Vec<D>& high);

}  // namespace odpd
