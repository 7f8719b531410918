#pragma once
// How particles move, given the unknowns q of a step:
//
//   v = P q + v_known,   r' = r + dt v,   p = P^T P q
//
// with the positions inside the box, the poses of rigid bodies, the images that slide under shear, and the momenta per
// mass p that particles of mass carry from step to step. No forces here: they are Dynamics' (dynamics/dynamics.h).
// Vectors of unknowns are flat, D numbers per node (operator/dof_map.h).
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "odpd/dynamics/step_record.h"
#include "odpd/dynamics/surroundings.h"
#include "odpd/operator/dof_map.h"

namespace odpd {

template <int D>
class Motion {
 public:
  using Unknowns = std::vector<double>;

  /// References must outlive this object.
  Motion(const Box<D>& box, Particles<D>& particles, const Surroundings<D>& surroundings)
      : box_(box),
        particles_(particles),
        surroundings_(surroundings),
        mass_(surroundings.constants().mass) {}

  Particles<D>& particles() { return particles_; }
  /// P of these particles.
  const DofMap<D>& dofs();
  /// Memory was reordered or a checkpoint read: forget what was derived from the particles.
  void particles_replaced() { dofs_.reset(); }

  /// What motion says of a stage with particles at these positions at this time: time, box, positions, arms, crossings,
  /// and velocities, prescribed ones and zeros. With shear the positions may have left the box since the step's start.
  /// Throws BlowUpError for a position that is not finite.
  void locate(std::span<const Vec<D>> positions, double time, Stage<D>& stage);
  /// P q + the stage's known velocities.
  std::vector<Vec<D>> velocities(const Stage<D>& stage, const Unknowns& q);
  /// Likewise angular velocities; empty where nobody spins.
  std::vector<Vec<D>> spins(const Stage<D>& stage, const Unknowns& q);

  /// position + dt velocity from time t on, wrapped (with shear single particles by `locate` only). Adds the mirror's
  /// catches to `crossings`. Throws BlowUpError as `move`.
  std::vector<Vec<D>> displaced(const std::vector<Vec<D>>& velocity, double dt, double t,
                                std::int64_t& crossings);
  /// Moves the particles by dt velocity from time t on and remembers it; returns the mirror's catches. Throws
  /// BlowUpError when a particle moves further than half the box in one step.
  std::int64_t move(const std::vector<Vec<D>>& velocity, double dt, double t);
  /// After `move`: velocities q of the step become those of the images that are now in the box.
  void cross_faces(Unknowns& q);

  /// inertia P^T P q: momenta, with a mass of `inertia` on every particle that moves, and moments of inertia in proportion.
  Unknowns times_inertia(const Stage<D>& stage, const Unknowns& q, double inertia);
  /// The unknowns of the particles' end velocities (zeros where they carry none), at the stage of a step's start.
  Unknowns end_velocity(const Stage<D>& stage);
  /// After `move`: sets them from momenta per mass p = P^T P q of the step, with the moments of inertia of where the
  /// bodies are now, as those of the images that are now in the box.
  void set_end_momentum(const Unknowns& p);

 private:
  void wrap_sheared(Stage<D>& stage) const;
  void check_paths(const std::vector<Vec<D>>& velocity, double dt) const;
  void leave_images(const std::vector<std::int32_t>& before);
  std::vector<std::int32_t> moving_images() const;
  void arms_at(const Box<D>& box, std::span<const Vec<D>> positions, std::vector<Vec<D>>& arms);
  void place_arms(Stage<D>& stage);
  void displace_bodies(const std::vector<Vec<D>>& velocity, double dt, const Box<D>& box,
                       std::vector<Vec<D>>& positions);
  /// Bodies, that is poses and constituents, move along the velocities of these. Returns constituents outside the box: the
  /// mirror does not turn bodies back, so this is an alarm.
  std::int64_t move_bodies(const std::vector<Vec<D>>& velocity, double dt, const Box<D>& box);

  // Of one body, on any thread; `dofs` was called.
  void count_boxes(std::size_t body, Stage<D>& stage) const;
  /// Moves a pose of the body along velocities of its constituents, wrapped in `box`. False when that changes no
  /// position.
  bool advance(std::size_t body, const std::vector<Vec<D>>& velocity, double dt, const Box<D>& box,
               BodyScratch<D>& scratch, RigidPose<D>& pose) const;
  void place(std::size_t body, const RigidPose<D>& pose, const Box<D>& box,
             std::vector<Vec<D>>& positions,
             std::vector<typename Particles<D>::Image>* images) const;

  const Box<D> box_;
  Particles<D>& particles_;
  const Surroundings<D>& surroundings_;
  const double mass_;
  std::unique_ptr<DofMap<D>> dofs_;
  std::vector<Vec<D>> faces_crossed_;  // with shear: velocity that each particle lost in `move`
  Box<D> moved_in_;                    // the box at the end of `move`
};

}  // namespace odpd
