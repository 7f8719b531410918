#pragma once
// What of a pair of particles belongs to the region between the wall surfaces, whose stress and pressure are measured: of the
// straight line between the two, the part inside (Irving and Kirkwood 1950). Along periodic directions everything is inside.
#include <algorithm>

#include "odpd/scene/scene.h"

namespace odpd {

template <int D>
class FluidRegion {
 public:
  /// `scene` must outlive it.
  explicit FluidRegion(const Scene<D>& scene)
      : box_(scene.box()), low_(scene.fluid_low()), high_(scene.fluid_high()) {}

  const Vec<D>& low() const { return low_; }
  const Vec<D>& high() const { return high_; }
  bool holds(const Vec<D>& r) const {
    for (int c = 0; c < D; ++c)
      if (!box_.is_periodic(c) && (r[c] < low_[c] || r[c] > high_[c])) return false;
    return true;
  }
  /// The part of the line r + s step, 0 <= s <= 1, that is inside: from <= s <= to, none where to <= from.
  struct Part {
    double from = 0.0, to = 1.0;
    double length() const { return std::max(to - from, 0.0); }
  };
  /// Of the line from r to r - arm, with r inside the box and arm to the nearest image.
  Part inside(const Vec<D>& r, const Vec<D>& arm) const {
    Part part;
    for (int c = 0; c < D; ++c)
      if (!box_.is_periodic(c)) clip(r[c], -arm[c], c, part);
    return part;
  }

 private:
  void clip(double r, double step, int c, Part& part) const {
    if (step == 0.0) {
      if (r < low_[c] || r > high_[c]) part.to = part.from;
      return;
    }
    const double s = (low_[c] - r) / step, t = (high_[c] - r) / step;
    part.from = std::max(part.from, std::min(s, t));
    part.to = std::min(part.to, std::max(s, t));
  }

  const Box<D>& box_;
  Vec<D> low_, high_;
};

}  // namespace odpd
