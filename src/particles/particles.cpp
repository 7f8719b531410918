#include "odpd/particles/particles.h"

#include <algorithm>

#include "odpd/core/error.h"
#include "odpd/core/index.h"

namespace odpd {

template <int D>
Particles<D>::Particles() {
  fields_.add("position", &position);
  fields_.add("image", &image);
  fields_.add("velocity", &velocity);
  fields_.add("id", &id);
  fields_.add("species", &species);
  fields_.add("group", &group);
}

template <int D>
void Particles<D>::carry_inertia() {
  if (inertial_) return;
  inertial_ = true;
  end_velocity.assign(position.size(), Vec<D>{});
  fields_.add("end_velocity", &end_velocity);
}

template <int D>
void Particles<D>::carry_spins(bool inertia) {
  if (!spinning_) {
    spinning_ = true;
    spin.assign(position.size(), Vec<D>{});
    fields_.add("spin", &spin);
  }
  if (!inertia || turning_) return;
  turning_ = true;
  end_spin.assign(position.size(), Vec<D>{});
  fields_.add("end_spin", &end_spin);
}

template <int D>
std::vector<Vec<D>>& Particles<D>::carry(const std::string& name) const {
  const auto [place, added] = carried_.try_emplace(name, position.size());
  if (added) fields_.add(name, &place->second);
  return place->second;
}

template <int D>
std::vector<std::int32_t> Particles<D>::owned_by_identity() const {
  std::vector<std::int32_t> own = index_of_id();
  const Share share = owned();
  if (!share.alone())
    std::erase_if(own, [&](std::int32_t i) { return !share.owns(std::int64_t{i}); });
  return own;
}

template <int D>
std::int64_t Particles<D>::free_count() const {
  const std::span<const Group> own = owned().part(std::span(group), 1);
  return ranks_->sum(
      std::int64_t{std::count_if(own.begin(), own.end(), [](Group g) { return g.is_free(); })});
}

template <int D>
std::int64_t Particles<D>::moving_count() const {
  const std::span<const Group> own = owned().part(std::span(group), 1);
  return ranks_->sum(
      std::int64_t{std::count_if(own.begin(), own.end(), [](Group g) { return !g.is_known(); })});
}

template <int D>
void Particles<D>::add(const Vec<D>& r, std::int32_t species_index, Group moved_by) {
  const std::size_t n = position.size();
  fields_.resize(n + 1);
  position[n] = r;
  image[n] = Image{};
  velocity[n] = Vec<D>{};
  id[n] = static_cast<std::int64_t>(n);
  species[n] = species_index;
  group[n] = moved_by;
}

template <int D>
void Particles<D>::add_body(RigidBody<D> body, const Box<D>& box, std::int32_t species_index) {
  const auto k = static_cast<std::int32_t>(bodies.size());
  body.members.clear();
  for (std::size_t c = 0; c < body.frame.size(); ++c) {
    body.members.push_back(size());
    add({}, species_index, body.known ? Group::known_body(k, walls) : Group::free_body(k));
    const auto at = position.size() - 1;
    place_constituent(body, body.pose, c, box, position[at], image[at]);
  }
  bodies.push_back(std::move(body));
}

template <int D>
void Particles<D>::save(StateWriter& out) const {
  fields_.save(out);
  std::vector<double> poses;
  std::vector<std::int64_t> images;
  for (const RigidBody<D>& body : bodies) {
    poses.insert(poses.end(), body.pose.centre.x.begin(), body.pose.centre.x.end());
    const auto q = body.pose.orientation.values();
    poses.insert(poses.end(), q.begin(), q.end());
    images.insert(images.end(), body.pose.image.begin(), body.pose.image.end());
  }
  if (bodies.empty()) return;
  out.write("body_poses", poses);
  out.write("body_images", images);
}

template <int D>
void Particles<D>::load(const StateReader& in) {
  fields_.load(in);
  if (bodies.empty()) return;
  const std::vector<double> poses = in.read_doubles("body_poses");
  const std::vector<std::int64_t> images = in.read_integers("body_images");
  constexpr std::size_t numbers = D + Rotation<D>::numbers;
  if (poses.size() != numbers * bodies.size() || images.size() != D * bodies.size())
    throw IoError("the checkpoint holds another number of bodies: it is of another case");
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    RigidPose<D>& pose = bodies[b].pose;
    for (std::size_t c = 0; c < D; ++c) {
      pose.centre.x[c] = poses[b * numbers + c];
      pose.image[c] = static_cast<std::int32_t>(images[b * D + c]);
    }
    pose.orientation.set(&poses[b * numbers + D]);
  }
}

template <int D>
std::vector<std::int32_t> Particles<D>::index_of_id() const {
  std::vector<std::int32_t> index_of(id.size());
  for (std::size_t i = 0; i < id.size(); ++i) index_of[index(id[i])] = static_cast<std::int32_t>(i);
  return index_of;
}

template class Particles<2>;
template class Particles<3>;

}  // namespace odpd
