#pragma once
// Obstacles and rigid bodies of a scene: sets of particles that keep their shape. A body is fixed, moves as given, or moves
// freely, with 3 (2D) or 6 (3D) unknowns.
#include <string>
#include <vector>

#include "odpd/core/config.h"
#include "odpd/geometry/box.h"
#include "odpd/particles/particles.h"

namespace odpd {

enum class BodyMotion { fixed, given, free };

template <int D>
struct SceneSettings;

/// One [[body]]: bodies of one shape, perhaps of several sizes.
template <int D>
struct BodySettings {
  std::string name = "body";
  /// Constituents, about their centre (length): of all bodies, or where there are `shapes` of the first.
  std::vector<Vec<D>> shape;
  std::vector<std::vector<Vec<D>>> shapes;  ///< of each body in turn, where they differ in size
  BodyMotion motion = BodyMotion::free;
  std::int32_t species = 0;
  std::int64_t count = 1;         ///< at random positions, where there are no `positions`
  std::vector<Vec<D>> positions;  ///< of the centres (length)
  /// Of each at `positions`; without any, `shape` is not turned.
  std::vector<Rotation<D>> orientations;
  double clearance = 1.0;   ///< free space around a body placed at random (length)
  RigidMotion<D> velocity;  ///< for BodyMotion::given
  RigidLoad<D> load;        ///< force and torque on each, for BodyMotion::free
  // What a calibration found (`odpd calibrate --radius`), for fractions and reports; 0: not known.
  double hydrodynamic_radius = 0.0;  ///< of the ball with its mobility (length)
  double excluded_volume = 0.0;      ///< that one takes from the fluid (length^d)

  std::int64_t bodies() const {
    return positions.empty() ? count : static_cast<std::int64_t>(positions.size());
  }
  const std::vector<Vec<D>>& shape_of(std::size_t body) const {
    return shapes.empty() ? shape : shapes[body];
  }
  /// Of a body at `positions`.
  Rotation<D> orientation(std::size_t body) const {
    return orientations.empty() ? Rotation<D>{} : orientations[body];
  }
  /// Constituents of all bodies.
  std::int64_t particles() const;
  /// Distance of the outermost constituent from the centre, of one body and of the largest.
  double radius(std::size_t body) const;
  double radius() const;
};

/// Reads one [[body]] but its species. Of the scene it needs box, walls, seed and how many [[body]] are before this one, whose radii
/// are others. Throws ConfigError, also for a body as long as half of an edge of the box.
template <int D>
BodySettings<D> read_body(const Config& entry, const SceneSettings<D>& scene);

/// Reads `hydrodynamic_radius` and `excluded_volume` of an entry whose bodies are read. Throws ConfigError where the space has no room for
/// them.
template <int D>
void read_body_sizes(const Config& entry, const SceneSettings<D>& scene, BodySettings<D>& body);

/// Turns a body as uniform random numbers u say: uniform over all orientations.
void turn_at_random(const std::array<double, 4>& u, Rotation<2>& orientation);
void turn_at_random(const std::array<double, 4>& u, Rotation<3>& orientation);

/// Adds all bodies to the particles, those of unknown motion first, each [[body]] in turn, and returns for each body of the
/// particles the index of its [[body]]. Random places (scene/random_places.h) lie between `low` and `high`; bodies at
/// `positions` stay there. Without `at_random` those without `positions` are left at `low`, for move_bodies. Throws ConfigError
/// where there is no room, with the share of it that was found.
template <int D>
std::vector<std::size_t> place_bodies(const std::vector<BodySettings<D>>& settings,
                                      const Box<D>& box, const Vec<D>& low, const Vec<D>& high,
                                      std::uint64_t seed, bool at_random, Particles<D>& particles);

/// Moves the bodies to where `constituents`, of each body in turn, lie. Throws ConfigError, naming `file`, where these are
/// other bodies.
template <int D>
void move_bodies(const std::vector<std::vector<Vec<D>>>& constituents, const Box<D>& box,
                 const std::string& file, Particles<D>& particles);

}  // namespace odpd
