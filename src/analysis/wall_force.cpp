#include "odpd/analysis/wall_force.h"

#include <fmt/format.h>

#include "odpd/core/index.h"
#include "odpd/operator/edge_sums.h"

namespace odpd {

template <int D>
WallForce<D>::WallForce(ObserverSettings settings, const Scene<D>& scene)
    : Observer<D>(std::move(settings), 2 * D * scene.settings().walls.size()), scene_(scene) {}

template <int D>
std::unique_ptr<Observer<D>> WallForce<D>::make(const ObserverEntry<D>& entry) {
  ObserverSettings settings = entry.settings();
  if (entry.scene.settings().walls.empty())
    entry.config.fail("kind", "the scene has no [[wall]] to feel a force");
  return std::make_unique<WallForce<D>>(std::move(settings), entry.scene);
}

template <int D>
std::string WallForce<D>::side(std::size_t wall) const {
  const auto& w = scene_.settings().walls[wall];
  return fmt::format("{}{}", "xyz"[w.axis], w.high ? '+' : '-');
}

template <int D>
double WallForce<D>::area(std::size_t wall) const {
  return scene_.box().volume() / scene_.box().size[scene_.settings().walls[wall].axis];
}

template <int D>
void WallForce<D>::add_stage(const Particles<D>& particles, const Stage<D>& stage,
                             const std::vector<Vec<D>>& noise_force, double weight,
                             std::vector<double>& sample) const {
  const Share own = particles.owned();
  std::vector<Vec<D>> force = noise_force;
  add_conservative_forces(stage.network, force);
  add_friction_forces<D>(stage.network, stage.velocity, force, stage.spin);
  add_sliding_friction(stage.network, force);
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (!particles.is_known(i) || particles.body_of(i) >= 0 || !own.owns(i)) continue;
    const auto wall = index(particles.group[i].known_mover());
    for (int c = 0; c < D; ++c) sample[wall * D + index(c)] += weight * force[i][c] / area(wall);
  }
  // The potential pushes a particle off the wall it is behind, and the wall the other way.
  std::vector<Vec<D>> push(stage.position.size());
  scene_.add_potential_forces(particles, stage.position, push);
  for (std::size_t w = 0; w < scene_.settings().walls.size(); ++w) {
    const auto& wall = scene_.settings().walls[w];
    double reaction = 0.0;
    for (const Vec<D>& f : own.part(std::span(push), 1))
      if (wall.high ? f[wall.axis] < 0.0 : f[wall.axis] > 0.0) reaction -= f[wall.axis];
    sample[w * D + index(wall.axis)] += weight * reaction / area(w);
  }
}

template <int D>
void WallForce<D>::measure(const Clock&, const Particles<D>& particles,
                           const StepRecord<D>& record) {
  std::vector<double> sample(this->average().width(), 0.0);
  std::vector<Vec<D>> noise(record.start.position.size());
  if (!record.edge_noise.empty())
    add_edge_forces<D>(record.start.network, record.edge_noise, noise);
  add_stage(particles, record.start, noise, record.start_weight, sample);
  if (record.has_corrector())
    add_stage(particles, record.corrector, noise, 1.0 - record.start_weight, sample);
  particles.ranks().sum(std::span(sample));
  const auto& settings = scene_.settings();
  for (std::size_t w = 0; w < settings.walls.size(); ++w) {
    const int facing = settings.wall_at(settings.walls[w].axis, !settings.walls[w].high);
    if (settings.walls[w].high || facing < 0) continue;
    for (std::size_t c = 0; c < D; ++c)
      sample[(settings.walls.size() + w) * D + c] =
          0.5 * (sample[w * D + c] - sample[index(facing) * D + c]);
  }
  this->add(std::move(sample));
}

template <int D>
std::vector<std::string> WallForce<D>::series_columns() const {
  std::vector<std::string> columns;
  for (const char* what : {"", "shear_"})
    for (std::size_t w = 0; w < scene_.settings().walls.size(); ++w)
      for (int c = 0; c < D; ++c)
        columns.push_back(fmt::format("{}{}_{}", what, side(w), "xyz"[c]));
  return columns;
}

template <int D>
void WallForce<D>::add_results(Results& results) const {
  const auto& settings = scene_.settings();
  for (std::size_t w = 0; w < settings.walls.size(); ++w)
    for (std::size_t c = 0; c < D; ++c)
      results.scalars.push_back(
          this->mean_of(w * D + c, this->named(fmt::format("{}.{}", side(w), "xyz"[c]))));
  for (std::size_t w = 0; w < settings.walls.size(); ++w) {
    const auto& wall = settings.walls[w];
    if (wall.high || settings.wall_at(wall.axis, true) < 0) continue;
    for (int c = 0; c < D; ++c) {
      if (c == wall.axis) continue;
      const std::size_t column = (settings.walls.size() + w) * D + index(c);
      results.scalars.push_back(
          this->mean_of(column, this->named(fmt::format("shear_stress.{}", "xyz"[c]))));
    }
  }
}

template class WallForce<2>;
template class WallForce<3>;

}  // namespace odpd
