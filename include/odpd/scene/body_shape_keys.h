#pragma once
// Keys of a [[body]] that give its sites and, where bodies of one entry differ in size, the radius of each,
//
//   R_k = mean + deviation w_k,   or   ln R_k = ln mean - s^2/2 + s w_k,  s^2 = ln(1 + (deviation/mean)^2)
//
// with w_k normal random numbers of the seed, of which [[body]] it is, and of which of its bodies.
#include <cstdint>
#include <string>
#include <vector>

#include "odpd/core/config.h"
#include "odpd/core/random.h"
#include "odpd/core/vec.h"

namespace odpd {

/// Keys that give a shape, all but its radius.
struct ShapeKeys {
  std::string name;
  double side = 0.0;        ///< of a square or cube (length)
  double length = 0.0;      ///< of a rod, over all (length)
  double aspect = 1.0;      ///< of an ellipsoid, along its axis to across
  double spacing = 0.0;     ///< of sites (length); 0: by their number
  std::int64_t layers = 1;  ///< of sites, a spacing apart
  std::int64_t number = 0;  ///< of sites: per side, on a ring or sphere; or of rings
  bool has_radius = false;
};

/// Throws ConfigError.
template <int D>
ShapeKeys read_shape_keys(const Config& entry);

/// Sites about their mean, of a body of this radius (length). Throws ConfigError where there are none, or the body is thinner than their
/// spacing.
template <int D>
std::vector<Vec<D>> centred_sites(const Config& entry, const ShapeKeys& keys, double radius);

/// Volume inside the outermost sites (length^d). Throws ConfigError where there is none.
template <int D>
double volume_inside(const Config& entry, const ShapeKeys& keys, double radius);

/// Points given as [{ at = [x, y] }, ...]. Throws ConfigError.
template <int D>
std::vector<Vec<D>> read_points(const Config& entry, const std::string& key);

/// Bodies of one entry whose radii are kept one by one, at most.
constexpr std::int64_t most_bodies = 10000000;

/// Radii of the bodies of one entry: one number, a list, or a distribution to draw from (length).
class Radii {
 public:
  /// `kind`: which [[body]]. Throws ConfigError.
  Radii(const Config& entry, const ShapeKeys& keys, std::uint64_t seed, std::size_t kind);
  bool differ() const { return !list_.empty() || deviation_ > 0.0; }
  const std::vector<double>& list() const { return list_; }
  double of(std::size_t body) const;

 private:
  void read_distribution(const Config& table);

  std::vector<double> list_;
  double mean_ = 0.0, deviation_ = 0.0;
  bool lognormal_ = false;
  CounterRandom random_;
  std::size_t kind_;
};

}  // namespace odpd
