#include "odpd/analysis/velocities.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "odpd/analysis/observer_keys.h"
#include "odpd/core/index.h"

namespace odpd {

namespace {

// Less the sheared flow where the image is whose velocity it is.
template <int D>
std::vector<Vec<D>> less_flow(const Stage<D>& stage, std::vector<Vec<D>> velocity) {
  if (!stage.box.shear) return velocity;
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    velocity[i] -= stage.box.flow_velocity(stage.position[i]);
    if (!stage.crossed.empty())
      velocity[i][stage.box.shear->flow] -= stage.crossed[i] * stage.box.sliding;
  }
  return velocity;
}

// Of all that moves: free particles and constituents of bodies of unknown motion.
template <int D>
Vec<D> mean_velocity(const Particles<D>& particles, const std::vector<Vec<D>>& velocity) {
  const Share own = particles.owned();
  Vec<D> mean{};
  for (auto i = index(own.first); i < index(own.end(particles.size())); ++i)
    if (!particles.is_known(i)) mean += velocity[i];
  own.ranks->sum(std::span(mean.x));
  return (1.0 / static_cast<double>(particles.moving_count())) * mean;
}

}  // namespace

template <int D>
Velocities<D>::Velocities(ObserverSettings settings, VelocitiesSettings velocities,
                          const Scene<D>& scene)
    : Observer<D>(std::move(settings),
                  (scene.settings().species.size() + scene.settings().molecules.size() +
                   scene.settings().bodies.size()) *
                      (1 + velocities.bins)),
      velocities_(std::move(velocities)),
      scene_(scene) {
  const SceneSettings<D>& s = scene.settings();
  const Particles<D>& particles = scene.particles();
  std::vector<double> free(s.species.size(), 0.0), bodies(s.bodies.size(), 0.0);
  for (std::size_t i = 0; i < particles.position.size(); ++i)
    if (particles.is_free(i)) free[index(particles.species[i])] += 1.0;
  for (std::size_t b = 0; b < particles.bodies.size(); ++b)
    if (!particles.bodies[b].known) bodies[scene.body_kind(b)] += 1.0;
  for (std::size_t k = 0; k < s.species.size(); ++k) add_kind(s.species[k].name, free[k], 1);
  first_molecule_ = kinds_.size();
  for (const MoleculeSettings<D>& m : s.molecules)
    add_kind("molecule." + m.name, static_cast<double>(m.molecules()), m.shape.size());
  first_body_ = kinds_.size();
  for (std::size_t k = 0; k < s.bodies.size(); ++k)
    add_kind("body." + s.bodies[k].name, bodies[k], s.bodies[k].shape.size());
}

template <int D>
void Velocities<D>::add_kind(std::string name, double population, std::size_t particles) {
  kinds_.push_back({std::move(name), population, variance_of(particles)});
}

template <int D>
double Velocities<D>::variance_of(std::size_t particles) const {
  const auto p = static_cast<double>(particles);
  const double share = scene_.conserves_momentum()
                           ? p / static_cast<double>(scene_.particles().moving_count())
                           : 0.0;
  return scene_.largest_kT() / (p * scene_.settings().mass) * (1.0 - share);
}

template <int D>
std::unique_ptr<Observer<D>> Velocities<D>::make(const ObserverEntry<D>& entry) {
  const Config& config = entry.config;
  if (entry.scene.settings().mass == 0.0)
    config.fail("kind",
                "at mass = 0 a particle has no velocity with a distribution of its own: that of a "
                "step is its displacement over dt, white noise whose variance goes with 1/dt. Give "
                "fluid.mass, or look at displacements (kind = \"msd\")");
  if (entry.scene.largest_kT() == 0.0)
    config.fail("kind", "at kT = 0 velocities have no spread to be compared with");
  VelocitiesSettings v;
  std::vector<int> still, all;
  for (int c = 0; c < D; ++c) {
    all.push_back(c);
    if (!flows_along(entry.scene, c)) still.push_back(c);
  }
  v.directions = read_directions<D>(config, still.empty() ? all : still);
  v.range = config.positive("range", v.range);
  v.bins = index(config.positive_integer("bins", static_cast<std::int64_t>(v.bins)));
  return std::make_unique<Velocities<D>>(entry.settings(5), std::move(v), entry.scene);
}

template <int D>
void Velocities<D>::count(std::size_t kind, const Vec<D>& v, std::vector<double>& sample) const {
  const Kind& k = kinds_[kind];
  if (!(k.variance > 0.0)) return;
  const double share = 1.0 / (k.population * static_cast<double>(velocities_.directions.size()));
  double* const out = &sample[kind * columns()];
  for (const int c : velocities_.directions) {
    const double u = v[c] / std::sqrt(k.variance);
    out[0] += share * u * u;
    const double bin = (u + velocities_.range) / bin_width();
    if (bin >= 0.0 && bin < static_cast<double>(velocities_.bins))
      out[1 + static_cast<std::size_t>(bin)] += share / bin_width();
  }
}

template <int D>
void Velocities<D>::measure(const Clock&, const Particles<D>& particles,
                            const StepRecord<D>& record) {
  std::vector<Vec<D>> v = less_flow(record.start, record.v_start);
  if (scene_.conserves_momentum()) {
    const Vec<D> mean = mean_velocity(particles, v);
    for (Vec<D>& velocity : v) velocity -= mean;
  }
  std::vector<double> sample(this->average().width(), 0.0);
  const Share own = particles.owned();
  for (auto i = index(own.first); i < index(own.end(particles.size())); ++i)
    if (particles.is_free(i)) count(index(particles.species[i]), v[i], sample);
  const std::vector<std::int32_t> index_of = particles.index_of_id();
  for (const Molecule& m : scene_.molecules()) {
    const auto first = index(m.first);
    if (!own.owns(std::int64_t{index_of[first]})) continue;
    const std::size_t p = scene_.settings().molecules[m.kind].shape.size();
    Vec<D> centre{};
    for (std::size_t k = 0; k < p; ++k)
      centre += (1.0 / static_cast<double>(p)) * v[index(index_of[first + k])];
    count(first_molecule_ + m.kind, centre, sample);
  }
  for (std::size_t b = 0; b < particles.bodies.size(); ++b) {
    const RigidBody<D>& body = particles.bodies[b];
    if (body.known || !own.owns(std::int64_t{index_of[index(body.members[0])]})) continue;
    Vec<D> centre{};
    for (const std::int64_t id : body.members)
      centre += (1.0 / static_cast<double>(body.members.size())) * v[index(index_of[index(id)])];
    // Bodies of one kind may differ in size: each in units of its own variance.
    const std::size_t kind = first_body_ + scene_.body_kind(b);
    const double own_variance = variance_of(body.members.size());
    if (own_variance != kinds_[kind].variance)
      centre *= std::sqrt(kinds_[kind].variance / own_variance);
    count(kind, centre, sample);
  }
  own.ranks->sum(std::span(sample));
  this->add(std::move(sample));
}

template <int D>
std::vector<std::string> Velocities<D>::series_columns() const {
  std::vector<std::string> columns;
  for (const Kind& kind : kinds_)
    if (kind.population > 0.0) columns.push_back(kind.name + ".variance");
  return columns;
}

template <int D>
std::vector<double> Velocities<D>::series_row() const {
  std::vector<double> row;
  for (std::size_t k = 0; k < kinds_.size() && !this->newest().empty(); ++k)
    if (kinds_[k].population > 0.0)
      row.push_back(kinds_[k].variance * this->newest()[k * columns()]);
  return row;
}

template <int D>
void Velocities<D>::add_results(Results& results) const {
  const BlockAverage& average = this->average();
  Table table;
  table.comment = {
      "density of u = v/sqrt(exact variance); velocities relative to their mean where "
      "momentum is conserved"};
  table.columns = {"u", "maxwell"};
  Chart chart{.title = "Components of velocities",
              .x_label = "v / sqrt(exact variance)",
              .y_label = "density",
              .curves = {}};
  Curve exact{.title = "Maxwell", .x = {}, .y = {}, .error = {}, .line = true, .points = false};
  for (std::size_t bin = 0; bin < velocities_.bins; ++bin) {
    const double u = bin_width() * (static_cast<double>(bin) + 0.5) - velocities_.range;
    exact.x.push_back(u);
    exact.y.push_back(std::exp(-0.5 * u * u) / std::sqrt(2.0 * std::numbers::pi));
    table.rows.push_back({u, exact.y.back()});
  }
  for (std::size_t k = 0; k < kinds_.size(); ++k) {
    const Kind& kind = kinds_[k];
    if (kind.population == 0.0) continue;
    const Scalar ratio = this->mean_of(k * columns(), this->named(kind.name + ".ratio"));
    results.scalars.push_back({this->named(kind.name + ".variance"), kind.variance * ratio.mean,
                               kind.variance * ratio.standard_error});
    results.scalars.push_back(ratio);
    table.comment.push_back(fmt::format("{}: exact variance {:.8g}", kind.name, kind.variance));
    table.columns.insert(table.columns.end(), {kind.name, kind.name + "_error"});
    Curve curve{.title = kind.name, .x = exact.x, .y = {}, .error = {}};
    for (std::size_t bin = 0; bin < velocities_.bins; ++bin) {
      const std::size_t column = k * columns() + 1 + bin;
      table.rows[bin].insert(table.rows[bin].end(),
                             {average.mean(column), average.standard_error(column)});
      curve.y.push_back(average.mean(column));
      curve.error.push_back(average.standard_error(column));
    }
    chart.curves.push_back(std::move(curve));
  }
  if (average.samples() == 0) return;
  chart.curves.push_back(std::move(exact));
  results.tables.emplace_back(this->settings().name, std::move(table));
  results.charts.emplace_back(this->settings().name, std::move(chart));
}

template class Velocities<2>;
template class Velocities<3>;

}  // namespace odpd
