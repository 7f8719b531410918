#pragma once
// One picture of the particles as files need it: plain arrays in identity order, free of D.
#include <cstdint>
#include <string>
#include <vector>

namespace odpd {

/// Arrays are ordered by ascending id. Vectors are flat: particle p, component c at
/// [p * dimension + c].
struct Frame {
  int dimension = 2;
  std::int64_t step = 0;
  double time = 0.0;
  std::vector<double> box_size;  ///< dimension edge lengths
  std::vector<double> edges;     ///< edge vectors of a tilted cell, one after the other; else empty
  std::vector<bool> periodic;    ///< dimension flags
  std::vector<std::int64_t> id;
  std::vector<std::int64_t> species;  ///< index into species_names
  std::vector<std::int64_t> group;    ///< 0 fluid, k >= 1: wall k
  std::vector<double> position;       ///< inside the box
  std::vector<std::int64_t> image;    ///< unwrapped = position + image * box_size
  std::vector<double> velocity;       ///< stage-mean velocity v_mid of the last step
  std::vector<double>
      spin;  ///< angular velocity of the last step, one number each in 2D, three in 3D; empty where nobody spins
  std::vector<double> density;  ///< of pairs/densities.h; empty where the model has none
  std::vector<std::string> species_names;
  std::vector<std::int64_t> bonds;  ///< ids i, j of each bond, flat; the same in all frames
};

}  // namespace odpd
