#include "odpd/particles/particles.h"

#include <algorithm>

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
std::int64_t Particles<D>::free_count() const {
  return std::count(group.begin(), group.end(), 0);
}

template <int D>
void Particles<D>::add(const Vec<D>& r, std::int32_t species_index, std::int32_t group_index) {
  const std::size_t n = position.size();
  fields_.resize(n + 1);
  position[n] = r;
  image[n] = Image{};
  velocity[n] = Vec<D>{};
  id[n] = static_cast<std::int64_t>(n);
  species[n] = species_index;
  group[n] = group_index;
}

template <int D>
std::vector<std::int32_t> Particles<D>::index_of_id() const {
  std::vector<std::int32_t> index(id.size());
  for (std::size_t i = 0; i < id.size(); ++i)
    index[static_cast<std::size_t>(id[i])] = static_cast<std::int32_t>(i);
  return index;
}

template class Particles<2>;
template class Particles<3>;

}  // namespace odpd
