#include "odpd/scene/scene.h"

#include <fmt/format.h>

#include <algorithm>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/scene/body_places.h"
#include "odpd/scene/fill.h"
#include "odpd/scene/spin_keys.h"
#include "odpd/scene/start_bonds.h"

namespace odpd {

namespace {

template <int D>
std::shared_ptr<const PairModel<D>> model_of(const SceneSettings<D>& settings) {
  if (settings.model == nullptr) throw ConfigError("the scene has no pair model");
  const int species = settings.model->species();
  if (species != 0 && index(species) != settings.species.size())
    throw ConfigError(
        fmt::format("the pair model is of {} species, the scene has {}: make it for all of them",
                    species, settings.species.size()));
  return settings.model;
}

}  // namespace

template <int D>
Scene<D>::Scene(SceneSettings<D> settings, const Communicator& ranks)
    : settings_(std::move(settings)),
      model_(model_of(settings_)),
      pair_moments_(odpd::pair_moments(*model_, settings_.species.size())),
      largest_kT_(odpd::largest_kT(pair_moments_)) {
  particles_.share_among(ranks);
  particles_.spin_of_species = spins_of(settings_.species);
  place_walls(settings_, particles_);
  particles_.walls = static_cast<std::int32_t>(settings_.walls.size());
  body_kind_ = place_bodies(settings_.bodies, settings_.box, fluid_low(), fluid_high(),
                            settings_.seed, settings_.start_bodies.empty(), particles_);
  if (!settings_.start_bodies.empty()) {
    move_bodies(settings_.start_bodies, settings_.box, settings_.start_file, particles_);
    check_start_bodies(settings_, body_kind_, particles_);
  }
  place_fluid(settings_, fluid_low(), fluid_high(), particles_);
  if (settings_.start != StartKind::file)
    place_molecules(settings_.molecules, settings_.box, fluid_low(), fluid_high(), settings_.seed,
                    particles_);
  join_molecules();
  relax(settings_.box, *model_, *this, settings_.relax_sweeps, particles_);
  join_images(bonds_, settings_.box, particles_);
  std::function<Vec<D>(const Vec<D>&)> flow;
  if (settings_.start_wave.number > 0)
    flow = [this](const Vec<D>& r) {
      return settings_.start_wave.at(r, settings_.box, settings_.start_velocity);
    };
  draw_velocities(settings_.seed, largest_kT(), settings_.mass, conserves_momentum(), flow,
                  particles_);
  if (settings_.box.shear) start_flow();
}

template <int D>
std::optional<double> Scene<D>::explicit_step_limit() const {
  const double mass = settings_.mass;
  std::optional<double> limit = odpd::explicit_step_limit(pair_moments_, mass);
  const auto reference = model_->reference_state(mass);
  if (limit && reference) limit = std::min(*limit, reference->accurate_step);
  return limit;
}

template <int D>
void Scene<D>::start_flow() {
  const Shear& shear = *settings_.box.shear;
  const auto up = index(shear.gradient);
  for (std::size_t i = 0; i < particles_.end_velocity.size(); ++i) {
    if (particles_.is_known(i)) continue;
    Vec<D>& v = particles_.end_velocity[i];
    v += settings_.box.flow_velocity(particles_.position[i]);
    v[shear.flow] +=
        (particles_.image[i][up] - particles_.moving_image(i)[up]) * settings_.box.sliding;
  }
  for (std::size_t i = 0; i < particles_.end_spin.size(); ++i)
    if (particles_.spins(i)) particles_.end_spin[i] += settings_.box.flow_spin();
}

// The particles are all there; those of molecules come last.
template <int D>
void Scene<D>::join_molecules() {
  molecules_ = list_molecules(settings_.molecules, particles_.size() - settings_.molecule_beads());
  bonds_ = bonds_of(settings_.molecules, molecules_);
  const std::int64_t first =
      particles_.size() - static_cast<std::int64_t>(settings_.start_positions.size());
  for (Bond bond : settings_.start_bonds) {
    bond.i += first;
    bond.j += first;
    bonds_.push_back(bond);
  }
  check_start_bonds(settings_, largest_kT(), molecules_, bonds_, particles_);
  if (!bonds_.empty())
    model_ = std::make_unique<BondedModel<D>>(std::move(model_), bonds_,
                                              frames_of(settings_.molecules, molecules_));
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
      const double h = particles.is_known(i) ? 0.0 : depth_behind(wall, positions[i]);
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
  const Share own = particles.owned();
  double energy = 0.0;
  for (const auto& wall : settings_.walls)
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const double u = particles.is_known(i) ? 0.0 : wall_energy(wall, positions[i]);
      if (!(u > 0.0)) continue;
      if (own.owns(i)) energy += u;
      laplacian[i] += wall.stiffness;
    }
  return energy;
}

template <int D>
void Scene<D>::add_driving_forces(const Particles<D>& particles, std::span<const Vec<D>> positions,
                                  double t, std::vector<Vec<D>>& force) const {
  Vec<D> net{};
  for (std::size_t b = 0; b < particles.bodies.size(); ++b) net += body_load(b, t).force;
  if (settings_.largest_force() == 0.0 && net == Vec<D>{}) return;
  const Share own = particles.owned();
  if (own.ranks->rank() > 0) net = {};  // bodies count once
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (particles.is_known(i)) continue;
    const Vec<D> f = settings_.force_at(positions[i]);
    force[i] += f;
    if (own.owns(i)) net += f;
  }
  if (settings_.held()) return;
  own.ranks->sum(std::span(net.x));
  // Nothing takes up a net force (of bodies that are pushed, of a wave on these particles), so it would have no answer.
  const Vec<D> share = 1.0 / static_cast<double>(particles.free_count()) * net;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (particles.is_free(i)) force[i] -= share;
}

template <int D>
Vec<D> Scene<D>::known_velocity(Group group, double) const {
  return settings_.walls[index(group.known_mover())].velocity;
}

template <int D>
RigidMotion<D> Scene<D>::known_motion(std::size_t body, double) const {
  return body_settings(body).velocity;
}

template <int D>
RigidLoad<D> Scene<D>::body_load(std::size_t body, double) const {
  return body_settings(body).load;
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
