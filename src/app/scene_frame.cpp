#include "odpd/app/scene_frame.h"

#include "odpd/core/index.h"

namespace odpd {

std::vector<std::int64_t> bond_ends(const std::vector<Bond>& bonds) {
  std::vector<std::int64_t> ends;
  for (const Bond& bond : bonds) ends.insert(ends.end(), {bond.i, bond.j});
  return ends;
}

template <int D>
Frame scene_frame(const Scene<D>& scene, const Clock& clock, std::span<const double> density) {
  const Particles<D>& particles = scene.particles();
  Frame frame;
  frame.dimension = D;
  frame.step = clock.step;
  frame.time = clock.time();
  for (int c = 0; c < D; ++c) {
    frame.box_size.push_back(scene.box().size[c]);
    frame.periodic.push_back(scene.box().is_periodic(c));
  }
  if (const Box<D> box = scene.box().at(clock.time()); box.shear) {
    frame.edges.assign(index(D * D), 0.0);
    for (int c = 0; c < D; ++c) frame.edges[index(c * (D + 1))] = box.size[c];
    frame.edges[index(box.shear->gradient * D + box.shear->flow)] = box.offset;
  }
  for (const SpeciesSettings& s : scene.settings().species) frame.species_names.push_back(s.name);
  frame.bonds = bond_ends(scene.bonds());
  for (const std::int32_t row : particles.index_of_id()) {
    const auto i = index(row);
    frame.id.push_back(particles.id[i]);
    frame.species.push_back(particles.species[i]);
    frame.group.push_back(particles.group[i].code());
    if (!density.empty()) frame.density.push_back(density[i]);
    for (std::size_t c = 0; c < D; ++c) {
      frame.position.push_back(particles.position[i].x[c]);
      frame.image.push_back(particles.image[i][c]);
      frame.velocity.push_back(particles.velocity[i].x[c]);
    }
    for (std::size_t c = 0; c < rotation_components<D> && !particles.spin.empty(); ++c)
      frame.spin.push_back(particles.spin[i].x[c]);
  }
  return frame;
}

template Frame scene_frame<2>(const Scene<2>&, const Clock&, std::span<const double>);
template Frame scene_frame<3>(const Scene<3>&, const Clock&, std::span<const double>);

}  // namespace odpd
