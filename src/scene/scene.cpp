#include "odpd/scene/scene.h"

#include <algorithm>

#include "odpd/scene/fill.h"

namespace odpd {

template <int D>
Scene<D>::Scene(SceneSettings<D> settings)
    : settings_(std::move(settings)),
      model_(std::make_unique<DpdModel<D>>(static_cast<int>(settings_.species.size()),
                                           settings_.pairs)) {
  place_walls(settings_, particles_);
  place_fluid(settings_, fluid_low(), fluid_high(), particles_);
  relax(settings_.box, *model_, *this, settings_.relax_sweeps, particles_);
  draw_velocities(settings_.seed, largest_kT(), settings_.mass, conserves_momentum(), particles_);
  for (std::size_t i = 0; i < particles_.end_velocity.size() && settings_.box.shear; ++i)
    particles_.end_velocity[i] += settings_.box.flow_velocity(particles_.position[i]);
}

template <int D>
double Scene<D>::largest_kT() const {
  double kT = 0.0;
  for (const DpdParameters& p : settings_.pairs) kT = std::max(kT, p.kT);
  return kT;
}

template <int D>
double Scene<D>::depth_behind(const WallSettings<D>& wall, const Vec<D>& r) const {
  return wall.high ? r[wall.axis] - (settings_.box.size[wall.axis] - wall.thickness)
                   : wall.thickness - r[wall.axis];
}

template <int D>
void Scene<D>::add_potential_forces(const Particles<D>& particles,
                                    std::span<const Vec<D>> positions,
                                    std::vector<Vec<D>>& force) const {
  for (const auto& wall : settings_.walls)
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const double h = particles.is_free(i) ? depth_behind(wall, positions[i]) : 0.0;
      if (h > 0.0) force[i][wall.axis] += (wall.high ? -1.0 : 1.0) * wall.stiffness * h;
    }
}

template <int D>
double Scene<D>::wall_energy(const WallSettings<D>& wall, const Vec<D>& r) const {
  const double h = depth_behind(wall, r);
  return h > 0.0 ? 0.5 * wall.stiffness * h * h : 0.0;
}

template <int D>
double Scene<D>::potential_energy_at(const Vec<D>& r) const {
  double energy = 0.0;
  for (const auto& wall : settings_.walls) energy += wall_energy(wall, r);
  return energy;
}

template <int D>
double Scene<D>::potential_energy(const Particles<D>& particles, std::span<const Vec<D>> positions,
                                  std::vector<double>& laplacian) const {
  double energy = 0.0;
  for (const auto& wall : settings_.walls)
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const double u = particles.is_free(i) ? wall_energy(wall, positions[i]) : 0.0;
      if (!(u > 0.0)) continue;
      energy += u;
      laplacian[i] += wall.stiffness;
    }
  return energy;
}

template <int D>
void Scene<D>::add_driving_forces(const Particles<D>& particles, std::span<const Vec<D>>, double,
                                  std::vector<Vec<D>>& force) const {
  if (dot(settings_.body_force, settings_.body_force) == 0.0) return;
  for (std::size_t i = 0; i < force.size(); ++i)
    if (particles.is_free(i)) force[i] += settings_.body_force;
}

template <int D>
Vec<D> Scene<D>::known_velocity(std::int32_t group, const Vec<D>&, double) const {
  return settings_.walls[static_cast<std::size_t>(group - 1)].velocity;
}

template <int D>
bool Scene<D>::confine(Vec<D>& r) const {
  bool caught = false;
  for (int c = 0; c < D; ++c) {
    if (settings_.box.is_periodic(c)) continue;
    const double length = settings_.box.size[c];
    if (r[c] >= 0.0 && r[c] <= length) continue;
    caught = true;
    const double mirrored = r[c] < 0.0 ? -r[c] : 2.0 * length - r[c];
    r[c] = std::clamp(mirrored, 0.0, length);
  }
  return caught;
}

template class Scene<2>;
template class Scene<3>;

}  // namespace odpd
