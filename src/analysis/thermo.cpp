#include "odpd/analysis/thermo.h"

#include <cmath>

#include "odpd/analysis/fluid_region.h"
#include "odpd/analysis/force_points.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/core/rotation.h"
#include "odpd/operator/edge_sums.h"

namespace odpd {

template <int D>
void configurational_terms(const Scene<D>& scene, const Particles<D>& particles,
                           const Stage<D>& stage, std::vector<double>& force_squared,
                           std::vector<double>& laplacian, double& wall_energy) {
  laplacian.assign(stage.position.size(), 0.0);
  force_squared.assign(stage.position.size(), 0.0);
  add_laplacian(stage.network, laplacian);
  wall_energy = scene.potential_energy(particles, stage.position, laplacian);
  for (std::size_t i = 0; i < stage.position.size(); ++i) {
    if (particles.is_free(i)) {
      force_squared[i] = dot(stage.potential_force[i], stage.potential_force[i]);
    } else {
      laplacian[i] = 0.0;
    }
  }
}

template <int D>
double kinetic_temperature(const Scene<D>& scene, const Particles<D>& particles,
                           const std::vector<Vec<D>>& velocity) {
  const double mass = scene.settings().mass;
  if (mass == 0.0) return 0.0;
  if (velocity.empty()) return std::nan("");  // Monte Carlo has no velocities
  const auto n = static_cast<double>(particles.free_count());
  const bool conserved = scene.conserves_momentum();
  const Share own = particles.owned();
  Vec<D> mean{};
  for (std::size_t i = 0; i < velocity.size() && conserved; ++i)
    if (particles.is_free(i) && own.owns(i)) mean += (1.0 / n) * velocity[i];
  own.ranks->sum(std::span(mean.x));
  double square = 0.0;
  for (std::size_t i = 0; i < velocity.size(); ++i)
    if (particles.is_free(i) && own.owns(i)) square += dot(velocity[i] - mean, velocity[i] - mean);
  square = own.ranks->sum(square);
  return mass * square / (D * (conserved ? n - 1.0 : n));
}

namespace {

// Free particles of this rank and bodies of unknown motion, each of these one particle at its centre and its first member's
// rank's, between the wall surfaces.
template <int D>
double centres_inside(const Particles<D>& particles, const ForcePoints<D>& points,
                      const FluidRegion<D>& region) {
  const Share own = particles.owned();
  double count = 0.0;
  for (std::size_t i = 0; i < particles.group.size(); ++i)
    if (particles.is_free(i) && own.owns(i) && region.holds(points.at(i))) count += 1.0;
  if (particles.bodies.empty()) return count;
  const std::vector<std::int32_t> index_of = particles.index_of_id();
  for (const RigidBody<D>& body : particles.bodies) {
    const auto first = index(index_of[index(body.members[0])]);
    if (!body.known && own.owns(first) && region.holds(points.at(first))) count += 1.0;
  }
  return count;
}

// Velocities less those of the flow that a shear imposes.
template <int D>
std::vector<Vec<D>> peculiar(const Stage<D>& stage, std::vector<Vec<D>> velocity) {
  for (std::size_t i = 0; i < velocity.size() && stage.box.shear; ++i)
    velocity[i] -= stage.box.flow_velocity(stage.position[i]);
  return velocity;
}

template <int D>
double moment_of(const Particles<D>& particles, std::size_t i) {
  return particles.spins(i) ? particles.spin_of_species[index(particles.species[i])].moment : 0.0;
}

// Of the free particles that have a moment of inertia; NaN where velocities are not known.
template <int D>
double rotational_temperature(const Particles<D>& particles, const StepRecord<D>& record) {
  if (record.w_start.empty()) return std::nan("");
  const Vec<D> mean = record.start.box.flow_spin();
  const Share own = particles.owned();
  std::array<double, 2> sum{};  // of I w^2, of components
  for (std::size_t i = 0; i < record.w_start.size(); ++i) {
    const double moment = moment_of(particles, i);
    if (moment == 0.0 || !own.owns(i)) continue;
    const Vec<D> w = record.w_start[i] - mean;
    sum[0] += moment * dot(w, w);
    sum[1] += rotation_components<D>;
  }
  own.ranks->sum(std::span(sum));
  return sum[0] / sum[1];
}

template <int D>
bool some_turn(const Scene<D>& scene, bool in_time) {
  if (!in_time || scene.settings().mass == 0.0) return false;
  const Particles<D>& particles = scene.particles();
  for (std::size_t i = 0; i < particles.species.size(); ++i)
    if (moment_of(particles, i) > 0.0) return true;
  return false;
}

std::vector<std::string> thermo_columns(bool turns) {
  std::vector<std::string> columns{"energy_per_particle", "pressure", "force_squared", "laplacian",
                                   "kinetic_temperature"};
  if (turns) columns.push_back("rotational_temperature");
  return columns;
}

}  // namespace

template <int D>
Thermo<D>::Thermo(ObserverSettings settings, const Scene<D>& scene, bool in_time)
    : Observer<D>(std::move(settings), thermo_columns(some_turn(scene, in_time))),
      scene_(scene),
      in_time_(in_time),
      turns_(some_turn(scene, in_time)) {}

template <int D>
std::unique_ptr<Observer<D>> Thermo<D>::make(const ObserverEntry<D>& entry) {
  return std::make_unique<Thermo<D>>(entry.settings(5), entry.scene, entry.in_time);
}

template <int D>
void Thermo<D>::measure(const Clock&, const Particles<D>& particles, const StepRecord<D>& record) {
  const PairNetwork<D>& network = record.start.network;
  std::vector<double> force_squared, laplacian, virial(index(network.size()));
  double wall_energy = 0.0;
  configurational_terms(scene_, particles, record.start, force_squared, laplacian, wall_energy);
  const ForcePoints<D> points(particles, record.start);
  const FluidRegion<D> region(scene_);
  for (std::size_t k = 0; k < virial.size(); ++k) {
    if (!network.counts(k)) continue;
    const Vec<D> arm = points.between(network, k);
    const Vec<D> r = points.at(index(network.i[k]));
    virial[k] = region.inside(r, arm).length() * dot(arm, network.push(k));
  }
  const Share own = particles.owned();
  const double centres = own.ranks->sum(centres_inside(particles, points, region));
  const double sum_of_virial = own.ranks->sum(fixed_sum(virial));
  std::vector<double> sample{
      (network.energy() + own.ranks->sum(wall_energy)) /
          static_cast<double>(particles.moving_count()),
      (centres * scene_.largest_kT() + sum_of_virial / D) / scene_.fluid_volume(),
      own.sum(force_squared), own.sum(laplacian),
      kinetic_temperature(scene_, particles, peculiar(record.start, record.v_start))};
  if (turns_) sample.push_back(rotational_temperature(particles, record));
  this->add(std::move(sample));
}

template <int D>
void Thermo<D>::add_results(Results& results) const {
  // The default observer's names carry no prefix: every run has them.
  const std::string prefix = this->settings().name == "thermo" ? "" : this->named("");
  results.scalars.push_back(this->mean_of(0, prefix + "energy_per_particle"));
  results.scalars.push_back(this->mean_of(1, prefix + "pressure"));
  const std::vector<BlockAverage::RatioTerm> terms{{1.0, 2, 3}};
  // Without a conservative force this is 0/0: undefined, and written as null.
  const std::string temperature = prefix + "config_temperature";
  if (some_force_jumps(scene_.pair_moments())) {
    results.scalars.push_back({temperature});
    results.notes.push_back(
        temperature +
        " is undefined: the conservative force of some pair of species jumps at its end, where its "
        "stiffness has no value. Let it go to 0 there, or enlarge its cutoff");
  } else {
    results.scalars.push_back(
        {temperature, this->average().ratio(2, 3), this->average().ratio_error(terms)});
  }
  if (scene_.settings().mass > 0.0 && in_time_)
    results.scalars.push_back(this->mean_of(4, prefix + "kinetic_temperature"));
  if (turns_) results.scalars.push_back(this->mean_of(5, prefix + "rotational_temperature"));
}

template void configurational_terms<2>(const Scene<2>&, const Particles<2>&, const Stage<2>&,
                                       std::vector<double>&, std::vector<double>&, double&);
template void configurational_terms<3>(const Scene<3>&, const Particles<3>&, const Stage<3>&,
                                       std::vector<double>&, std::vector<double>&, double&);
template double kinetic_temperature<2>(const Scene<2>&, const Particles<2>&,
                                       const std::vector<Vec<2>>&);
template double kinetic_temperature<3>(const Scene<3>&, const Particles<3>&,
                                       const std::vector<Vec<3>>&);
template class Thermo<2>;
template class Thermo<3>;

}  // namespace odpd
