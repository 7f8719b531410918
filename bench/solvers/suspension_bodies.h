#pragma once
// The rigid bodies of the benchmark's suspensions: their sites, how many there are, and the box that holds them.
#include <cstdint>
#include <vector>

#include "odpd/scene/bodies.h"

namespace bench {

enum class SiteShape {
  round,   ///< a disk (2D), the surface of a sphere (3D), as case files have them
  filled,  ///< a cubic lattice throughout a ball (3D)
  line,    ///< a rod
};

struct BodySpec {
  SiteShape shape = SiteShape::round;
  double share =
      0.3;  ///< of the mobile particles that are sites, as near as whole bodies come to it
  double radius = 1.0;    ///< of the outermost sites (length)
  double spacing = 0.45;  ///< of neighbouring sites, as near as whole rings come to it (length)
  double gap = 0.1;       ///< least distance between circumscribed balls at the start (length)
  bool packed =
      false;  ///< on a triangular or face-centred lattice, as dense as the fluid in between allows
  bool anywhere = false;  ///< at random places, through each other
};

/// How a number of mobile particles becomes bodies and fluid in a box.
template <int D>
struct Suspension {
  odpd::BodySettings<D> bodies;  ///< with `positions` where they are packed
  std::int64_t free = 0;         ///< particles of the fluid
  odpd::Vec<D> size{};           ///< of the periodic box (length)

  std::int64_t sites() const {
    return bodies.bodies() * static_cast<std::int64_t>(bodies.shape.size());
  }
};

/// Of fluid at this density outside of the bodies; `thin`: length of direction 0, 0 for a square or cube. Throws ConfigError
/// where no whole bodies come within a quarter of the share, or where they are too large for the box.
template <int D>
Suspension<D> suspend(const BodySpec& spec, std::int64_t particles, double density, double thin,
                      std::uint64_t seed);

/// Gives bodies orientations at random: those with `positions` have none of their own.
template <int D>
void turn_bodies(std::uint64_t seed, const odpd::Box<D>& box, odpd::Particles<D>& particles);

/// Puts a body there.
template <int D>
void place_body(std::size_t body, const odpd::RigidPose<D>& pose, const odpd::Box<D>& box,
                const std::vector<std::int32_t>& index_of_id, odpd::Particles<D>& particles);

}  // namespace bench
