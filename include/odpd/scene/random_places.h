#pragma once
// Random places for balls of radii R_i in a box: none overlaps with another one or with those that are there,
//
//   |x_i - x_j| >= R_i + R_j,   low_c + R_i <= x_i,c <= high_c - R_i   in bounded directions c.
//
// Each in turn is put at the first of 10^4 uniform places that is free (random sequential addition, Widom 1966). That slows
// down and jams before .547 of the area or .38 of the volume is filled. Where a ball finds no place, all are packed:
//
//   grow and relax   the balls left over go to any places and the radii shrink to s R_i. Then s grows in steps, at each of
//                    which pairs that overlap push each other apart, one after the other (after Jodrey & Tory 1985)
//   mix              Monte Carlo sweeps of hard balls (Metropolis et al. 1953), which forget how the places were found
//
// So dense places are those of hard balls in equilibrium. All is a function of the seed.
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/geometry/ball_cells.h"

namespace odpd {

template <int D>
struct RandomPlaces {
  std::vector<Vec<D>> centres;          ///< inside the box
  std::vector<std::uint64_t> attempts;  ///< of each ball: which of its uniform places was taken
  /// 1. Where there is no room for all, the largest s for which there was, and no centres. Where a ball has no place even
  /// without the others, 0 and the centres of those before it.
  double scale = 1.0;
};

/// Places between `low` and `high` for balls of these radii, clear of those that are `there` already.
template <int D>
RandomPlaces<D> find_random_places(const Box<D>& box, const Vec<D>& low, const Vec<D>& high,
                                   const BallCells<D>& there, std::span<const double> radii,
                                   std::uint64_t seed);

}  // namespace odpd
