#pragma once
// The particles: positions r_i, stage-mean velocities v_i, and who they are. Structure of arrays.
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "odpd/core/archive.h"
#include "odpd/core/communicator.h"
#include "odpd/core/vec.h"
#include "odpd/particles/field_table.h"
#include "odpd/particles/group.h"
#include "odpd/particles/rigid_body.h"
#include "odpd/particles/spin.h"

namespace odpd {

template <int D>
class Particles {
 public:
  using Image = std::array<std::int32_t, index(D)>;

  Particles();
  Particles(const Particles&) = delete;  // the field table points into this object
  Particles& operator=(const Particles&) = delete;

  std::vector<Vec<D>> position;  ///< inside the box along periodic directions; length
  std::vector<Image> image;      ///< box crossings: unwrapped = position + image * size
  std::vector<Vec<D>> velocity;  ///< v_mid of the last step (prescribed for walls); length/time
  /// v' at the end of the last step, whose variance is kT/m; empty unless carry_inertia was called; length/time. Of
  /// constituents that of `moving_image`.
  std::vector<Vec<D>> end_velocity;
  // Angular velocities, in 2D (w, 0); empty unless carry_spins was called; 1/time.
  std::vector<Vec<D>> spin;  ///< as `velocity`; of constituents that of their body
  std::vector<Vec<D>>
      end_spin;  ///< as `end_velocity`, of variance kT/I; 0 where the moment of inertia is
  /// Persistent identity, 0, 1, ...; survives reordering and restart.
  std::vector<std::int64_t> id;
  std::vector<std::int32_t> species;  ///< index into the scene's species
  std::vector<Group> group;           ///< who moves it
  std::vector<Spin> spin_of_species;  ///< by species; empty: nobody spins
  std::int32_t walls = 0;  ///< of the scene: bodies of known motion are counted behind them (Group)
  std::vector<RigidBody<D>> bodies;  ///< those of unknown motion first

  std::int64_t size() const { return static_cast<std::int64_t>(position.size()); }
  bool is_free(std::size_t i) const { return group[i].is_free(); }
  bool is_known(std::size_t i) const { return group[i].is_known(); }
  /// It has an angular velocity of its own. One that moves with a wall or a body has that of the wall (0) or body.
  bool spins(std::size_t i) const {
    return !spin_of_species.empty() && is_free(i) &&
           spin_of_species[index(species[i])].lever_radius > 0.0;
  }
  /// Rigid body of a particle, -1 when it belongs to none.
  std::int32_t body_of(std::size_t i) const { return bodies.empty() ? -1 : group[i].body(walls); }
  /// Of all ranks, which call it together.
  std::int64_t free_count() const;
  /// Those of all ranks that move: free ones and constituents of bodies of unknown motion.
  std::int64_t moving_count() const;

  /// From now on each of these ranks owns a run of memory. `ranks` must outlive this object.
  void share_among(const Communicator& ranks) { ranks_ = &ranks; }
  const Communicator& ranks() const { return *ranks_; }
  /// The particles of this rank: whoever sums over particles takes these, and adds up the ranks' sums. So far every rank
  /// holds the others' too.
  Share owned() const { return Share::of(*ranks_, size()); }
  /// Where images differ in velocity (shear), a particle moves as the one in the box, a constituent as the image that hangs
  /// together with its body's centre in the box. Boxes are counted from the same origin as `image`.
  const Image& moving_image(std::size_t i) const {
    const std::int32_t body = body_of(i);
    return body < 0 ? image[i] : bodies[index(body)].pose.image;
  }

  /// From now on `end_velocity` has an entry per particle, at first zero, and is state like the other fields.
  void carry_inertia();
  /// Likewise `spin`, and with `inertia` `end_spin`.
  void carry_spins(bool inertia);
  /// A vector per particle that an integrator or an observer keeps from step to step under this name, zero at first, the
  /// same whenever the name comes again: it is reordered, saved and loaded with the particles. It belongs to whoever asks,
  /// so it is none of their own state and may be had from const particles. A restart finds the names given before `load`.
  std::vector<Vec<D>>& carry(const std::string& name) const;
  /// Appends one particle with the next identity, at rest.
  void add(const Vec<D>& r, std::int32_t species_index, Group moved_by = {});
  void reorder(const std::vector<std::int32_t>& order) { fields_.reorder(order); }
  /// This rank's particles in the order of their identities, for sums that no reordering of memory may change.
  std::vector<std::int32_t> owned_by_identity() const;
  /// Memory index of each identity: result[id] = i.
  std::vector<std::int32_t> index_of_id() const;

  /// Appends a body and its constituents, which make its `members`. Those of unknown motion come before the others.
  void add_body(RigidBody<D> body, const Box<D>& box, std::int32_t species_index);

  void save(StateWriter& out) const;
  /// Throws IoError when a field is missing or of another length than the others.
  void load(const StateReader& in);

 private:
  mutable FieldTable<D> fields_;                                // `carry` adds to it
  mutable std::map<std::string, std::vector<Vec<D>>> carried_;  // by name
  bool inertial_ = false;
  bool spinning_ = false, turning_ = false;  // carry_spins was called, and with inertia
  const Communicator* ranks_ = &Communicator::alone();
};

}  // namespace odpd
