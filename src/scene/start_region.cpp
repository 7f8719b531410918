#include "odpd/scene/start_region.h"

#include <fmt/format.h>

#include <cmath>

#include "odpd/scene/vector_key.h"

namespace odpd {

template <int D>
double StartRegion<D>::volume() const {
  if (radius > 0.0) return unit_ball_volume<D> * std::pow(radius, D);
  double volume = 1.0;
  for (int c = 0; c < D; ++c) volume *= to[c] - from[c];
  return volume;
}

template <int D>
StartRegion<D> read_start_region(const Config& region) {
  const bool ball = region.has("centre") || region.has("radius");
  if (ball && (region.has("from") || region.has("to")))
    region.fail(region.has("from") ? "from" : "to",
                "give from and to, the corners of a block, or centre and radius, those of a ball");
  StartRegion<D> r;
  if (ball) {
    const Vec<D> centre = read_vector<D>(region, "centre");
    r.radius = region.positive("radius");
    for (int c = 0; c < D; ++c) {
      r.from[c] = centre[c] - r.radius;
      r.to[c] = centre[c] + r.radius;
    }
  } else {
    r.from = read_vector<D>(region, "from");
    r.to = read_vector<D>(region, "to");
  }
  for (int c = 0; c < D; ++c)
    if (!(r.to[c] > r.from[c]))
      region.fail("to", fmt::format("must lie above from in every direction, but along {} it is {} "
                                    "and from is {}",
                                    "xyz"[c], r.to[c], r.from[c]));
  return r;
}

template <int D>
void check_start_region(const Config& keys, const StartRegion<D>& region, const Vec<D>& low,
                        const Vec<D>& high) {
  for (int c = 0; c < D; ++c)
    if (region.from[c] < low[c] || region.to[c] > high[c])
      keys.fail(region.radius > 0.0       ? "radius"
                : region.from[c] < low[c] ? "from"
                                          : "to",
                fmt::format("the region reaches from {} to {} along {}, but the space for the "
                            "fluid from {} to {}",
                            region.from[c], region.to[c], "xyz"[c], low[c], high[c]));
}

template struct StartRegion<2>;
template struct StartRegion<3>;
template StartRegion<2> read_start_region<2>(const Config&);
template StartRegion<3> read_start_region<3>(const Config&);
template void check_start_region<2>(const Config&, const StartRegion<2>&, const Vec<2>&,
                                    const Vec<2>&);
template void check_start_region<3>(const Config&, const StartRegion<3>&, const Vec<3>&,
                                    const Vec<3>&);

}  // namespace odpd
