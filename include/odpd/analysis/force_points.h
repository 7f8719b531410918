#pragma once
// The molecular virial: forces on the constituents of a rigid body act at its centre, so that the constraint forces inside it
// need not be known.
#include "odpd/core/index.h"
#include "odpd/dynamics/step_record.h"
#include "odpd/particles/particles.h"

namespace odpd {

/// Where forces count: at the particles, or, on constituents of bodies whose motion is unknown, at the centres of those.
template <int D>
class ForcePoints {
 public:
  ForcePoints(const Particles<D>& particles, const Stage<D>& stage)
      : particles_(particles), stage_(stage) {}
  Vec<D> at(std::size_t i) const { return stage_.position[i] - arm(i); }
  /// From the point of j to that of i.
  Vec<D> between(const PairNetwork<D>& network, std::size_t k) const {
    const Vec<D> pair = network.r[k] * network.e[k];
    if (stage_.arms.empty()) return pair;
    return pair - arm(index(network.i[k])) + arm(index(network.j[k]));
  }

 private:
  Vec<D> arm(std::size_t i) const {
    return stage_.arms.empty() || !particles_.group[i].in_free_body() ? Vec<D>{} : stage_.arms[i];
  }

  const Particles<D>& particles_;
  const Stage<D>& stage_;
};

}  // namespace odpd
