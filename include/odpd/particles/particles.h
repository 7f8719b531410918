#pragma once
// The particles: positions r_i, stage-mean velocities v_i, and who they are. Structure of arrays.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "odpd/core/archive.h"
#include "odpd/core/vec.h"
#include "odpd/particles/field_table.h"

namespace odpd {

template <int D>
class Particles {
 public:
  using Image = std::array<std::int32_t, static_cast<std::size_t>(D)>;

  Particles();
  Particles(const Particles&) = delete;  // the field table points into this object
  Particles& operator=(const Particles&) = delete;

  std::vector<Vec<D>> position;  ///< inside the box along periodic directions; length
  std::vector<Image> image;      ///< box crossings: unwrapped = position + image * size
  std::vector<Vec<D>> velocity;  ///< v_mid of the last step (prescribed for walls); length/time
  /// v' at the end of the last step, whose variance is kT/m; empty unless carry_inertia was called; length/time
  std::vector<Vec<D>> end_velocity;
  std::vector<std::int64_t>
      id;  ///< persistent identity, 0, 1, ...; survives reordering and restart
  std::vector<std::int32_t> species;  ///< index into the scene's species
  std::vector<std::int32_t> group;    ///< 0: free (fluid); k >= 1: moves with wall k-1 of the scene

  std::int64_t size() const { return static_cast<std::int64_t>(position.size()); }
  bool is_free(std::size_t i) const { return group[i] == 0; }
  std::int64_t free_count() const;

  /// From now on `end_velocity` has an entry per particle, at first zero, and is state like the other fields.
  void carry_inertia();
  /// Appends one particle with the next identity, at rest.
  void add(const Vec<D>& r, std::int32_t species_index, std::int32_t group_index);
  void reorder(const std::vector<std::int32_t>& order) { fields_.reorder(order); }
  /// Memory index of each identity: result[id] = i.
  std::vector<std::int32_t> index_of_id() const;

  void save(StateWriter& out) const { fields_.save(out); }
  void load(const StateReader& in) { fields_.load(in); }

 private:
  FieldTable<D> fields_;
  bool inertial_ = false;
};

}  // namespace odpd
