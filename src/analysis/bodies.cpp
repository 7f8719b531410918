#include "odpd/analysis/bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "odpd/analysis/frozen.h"
#include "odpd/core/index.h"
#include "odpd/operator/edge_sums.h"

namespace odpd {

namespace {

// The rotation vector (angle) that takes one orientation to another.
Vec<2> turn_between(const Rotation<2>& from, const Rotation<2>& to) {
  const auto a = from.values(), b = to.values();
  return {{std::atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]), 0.0}};
}
Vec<3> turn_between(const Rotation<3>& from, const Rotation<3>& to) {
  const auto a = from.values(), b = to.values();  // b a^-1
  const Vec<3> u{{a[1], a[2], a[3]}}, v{{b[1], b[2], b[3]}};
  double re = a[0] * b[0] + dot(u, v);
  Vec<3> im = a[0] * v - b[0] * u - swing(v, u);
  if (re < 0.0) {
    re = -re;
    im *= -1.0;
  }
  const double size = norm(im);
  return (size > 0.0 ? 2.0 * std::atan2(size, re) / size : 2.0) * im;
}

template <int D>
std::vector<std::size_t> kinds_of(const Scene<D>& scene) {
  std::vector<std::size_t> kinds;
  for (std::size_t b = 0; b < scene.particles().bodies.size(); ++b)
    kinds.push_back(scene.body_kind(b));
  return kinds;
}

template <int D>
std::vector<std::string> names_of(const Scene<D>& scene) {
  std::vector<std::string> names;
  for (const BodySettings<D>& body : scene.settings().bodies) names.push_back(body.name);
  return names;
}

}  // namespace

template <int D>
Bodies<D>::Bodies(ObserverSettings settings, BodiesSettings bodies, const Scene<D>& scene,
                  double dt, bool in_time)
    : Observer<D>(std::move(settings), scene.settings().bodies.size() * width + D),
      bodies_(bodies),
      in_time_(in_time),
      scene_(scene),
      kind_(kinds_of(scene)),
      names_(names_of(scene)),
      around_(bodies.around, names_, kind_),
      places_(this->settings().name, bodies.msd.window, bodies.msd.fit_from,
              dt * static_cast<double>(this->settings().every), scene.settings().bodies.size()),
      turns_(this->settings().name, bodies.msd.window, bodies.msd.fit_from,
             dt * static_cast<double>(this->settings().every), scene.settings().bodies.size()) {
  share_.assign(scene.settings().bodies.size(), 0.0);
  for (const std::size_t kind : kind_) share_[kind] += 1.0;
  for (double& s : share_) s = 1.0 / s;
  angle_.assign(kind_.size() * D, 0.0);
  if (bodies_.control.every == 0) return;
  const std::size_t directions = bodies_.msd.directions.size();
  for (std::size_t kind = 0; kind < names_.size(); ++kind)
    growth_.emplace_back(ModeGrowth::Settings{
        .window = bodies_.msd.window,
        .fit_from = bodies_.msd.fit_from,
        .dt = dt,
        .kT = scene.largest_kT(),
        .waves = 1,
        .modes_per_wave =
            directions * static_cast<std::size_t>(std::count(kind_.begin(), kind_.end(), kind)),
        .control_every = bodies_.control.every});
}

namespace {

// What keeps a run from showing the mobility by how displacements grow.
template <int D>
void refuse_control(const ObserverEntry<D>& entry, const ObserverSettings& settings) {
  const SceneSettings<D>& s = entry.scene.settings();
  const auto fail = [&](const std::string& why) { entry.config.fail("control", why); };
  if (settings.every != 1) fail("takes the noise of every step out: every must be 1");
  if (s.mass > 0.0) fail("needs fluid.mass = 0, where the solve of a step tells what noise does");
  if (!entry.two_stages)
    fail(
        "needs to know the second stage of a step: use the integrator 'trapezoidal' or 'midpoint'");
  if (!(entry.scene.largest_kT() > 0.0)) fail("measures by thermal motion: kT must be positive");
  if (s.zeta_0 > 0.0) fail("knows the noise of pairs alone: leave out fluid.zeta_0");
  if (s.driven()) fail("measures at equilibrium: nothing may drive, move or shear the scene");
  const auto free = [](const BodySettings<D>& body) { return body.motion == BodyMotion::free; };
  if (!std::all_of(s.bodies.begin(), s.bodies.end(), free))
    fail("is of free bodies: all [[body]] must be free");
}

}  // namespace

template <int D>
double Bodies<D>::solves() const {
  double solves = 0.0;
  for (const ModeGrowth& growth : growth_) solves += growth.solves();
  return solves;
}

template <int D>
std::unique_ptr<Observer<D>> Bodies<D>::make(const ObserverEntry<D>& entry) {
  if (entry.scene.settings().bodies.empty()) entry.config.fail("kind", "the scene has no [[body]]");
  BodiesSettings b;
  b.msd = read_msd(entry);
  b.around = read_fluid_around(entry);
  b.control = read_control(entry.config, b.msd.window, entry.clock.dt);
  if (!entry.in_time) b.control = {};  // sampling moves nothing
  const bool controlled = b.control.every > 0;
  ObserverSettings settings = entry.settings(controlled ? 1 : 2);
  if (controlled && entry.in_time) refuse_control(entry, settings);
  return std::make_unique<Bodies<D>>(std::move(settings), b, entry.scene, entry.clock.dt,
                                     entry.in_time);
}

template <int D>
void Bodies<D>::add_stage(const Stage<D>& stage, const StepRecord<D>& record,
                          const ParticleLoads<D>& noise, double weight,
                          std::vector<double>& sample) const {
  std::vector<Vec<D>> force(stage.position.size());
  add_conservative_forces(stage.network, force);
  add_friction_forces<D>(stage.network, stage.velocity, force, stage.spin);
  add_sliding_friction(stage.network, force);
  std::vector<Vec<D>> own_torque = noise.torque;  // about the constituents' centres
  if (!stage.spin.empty()) {
    add_friction_torques<D>(stage.network, stage.velocity, stage.spin, own_torque);
    add_sliding_torques(stage.network, own_torque);
  }
  for (std::size_t b = 0; b < kind_.size(); ++b) {
    Vec<D> total{}, moment{};
    for (const std::int32_t particle : members_[b]) {
      const auto p = index(particle);
      if (!stage.network.owned.owns(p)) continue;
      total += weight * (force[p] + noise.force[p]);
      // The random torque acts with the arms of the step's start in both stages, as the scheme has it.
      moment +=
          weight * (torque(stage.arms[p], force[p]) + torque(record.start.arms[p], noise.force[p]));
      if (!own_torque.empty()) moment += weight * own_torque[p];
    }
    double* const out = &sample[kind_[b] * width];
    for (std::size_t c = 0; c < D; ++c) out[c] += share_[kind_[b]] * total.x[c];
    for (std::size_t c = 0; c < turns; ++c) out[D + c] += share_[kind_[b]] * moment.x[c];
  }
}

template <int D>
void Bodies<D>::add_motion(const Particles<D>& particles, const StepRecord<D>& record,
                           std::vector<double>& sample) const {
  std::vector<Vec<D>> arms, velocities;
  const Stage<D>& start = record.start;
  // Velocity of the sheared flow at the place of i less an arm. Where a body is held, the flow is not known.
  const auto flow = [&](std::size_t i, const Vec<D>& arm) {
    if (!start.box.shear || scene_.settings().held()) return Vec<D>{};
    Vec<D> u = start.box.flow_velocity(start.position[i] - arm);
    u[start.box.shear->flow] += start.crossed[i] * start.box.sliding;
    return u;
  };
  for (std::size_t b = 0; b < kind_.size(); ++b) {
    arms.clear();
    velocities.clear();
    for (const std::int32_t p : members_[b]) {
      arms.push_back(start.arms[index(p)]);
      velocities.push_back(record.v_mid[index(p)]);
    }
    RigidMotion<D> motion;
    if (scene_.body_settings(b).motion != BodyMotion::fixed)
      motion = rigid_motion<D>(arms, velocities);
    if (scene_.body_settings(b).motion == BodyMotion::free)
      motion.velocity -= flow(index(members_[b][0]), arms[0]);
    if (particles.ranks().rank() > 0) continue;  // every rank knows the bodies' motion
    double* const out = &sample[kind_[b] * width + D + turns];
    for (std::size_t c = 0; c < D; ++c) out[c] += share_[kind_[b]] * motion.velocity.x[c];
    for (std::size_t c = 0; c < turns; ++c) out[D + c] += share_[kind_[b]] * motion.angular.x[c];
  }
  const double share = 1.0 / static_cast<double>(particles.free_count());
  const Share own = particles.owned();
  for (std::size_t i = 0; i < record.v_mid.size(); ++i)
    if (particles.is_free(i) && own.owns(i))
      for (std::size_t c = 0; c < D; ++c)
        sample[names_.size() * width + c] += share * (record.v_mid[i] - flow(i, {})).x[c];
}

template <int D>
void Bodies<D>::follow(const Particles<D>& particles) {
  std::vector<double> centres;
  std::vector<std::int32_t> kind;
  constexpr std::size_t numbers = Rotation<D>::numbers;
  const bool first = orientation_.empty();
  orientation_.resize(kind_.size() * numbers);
  for (std::size_t b = 0; b < kind_.size(); ++b) {
    const RigidPose<D>& pose = particles.bodies[b].pose;
    kind.push_back(particles.bodies[b].known ? -1 : static_cast<std::int32_t>(kind_[b]));
    for (std::size_t c = 0; c < D; ++c)
      centres.push_back(pose.centre.x[c] + pose.image[c] * scene_.box().size.x[c]);
    if (!first) {
      Rotation<D> before;
      before.set(&orientation_[b * numbers]);
      const Vec<D> turn = turn_between(before, pose.orientation);
      for (std::size_t c = 0; c < D; ++c) angle_[b * D + c] += turn.x[c];
    }
    const auto q = pose.orientation.values();
    std::copy(q.begin(), q.end(), orientation_.begin() + static_cast<std::ptrdiff_t>(b * numbers));
  }
  std::vector<int> rotations;
  for (int c = 0; c < rotation_components<D>; ++c) rotations.push_back(c);
  places_.add(std::move(centres), kind, D, bodies_.msd.directions);
  turns_.add(angle_, kind, D, rotations);
}

template <int D>
void Bodies<D>::count_fluid(const Particles<D>& particles, const Stage<D>& stage) {
  const Share own = particles.owned();
  std::vector<std::int32_t> fluid;
  for (auto i = index(own.first); i < index(own.end(particles.size())); ++i)
    if (particles.is_free(i)) fluid.push_back(static_cast<std::int32_t>(i));
  std::vector<Vec<D>> centres;
  for (std::size_t b = 0; b < kind_.size(); ++b) {
    const auto first = index(members_[b][0]);
    centres.push_back(stage.position[first] - stage.arms[first]);
  }
  around_.add(stage, centres, fluid,
              scene_.fluid_volume() / static_cast<double>(particles.free_count()), *own.ranks);
}

// Of each body and direction: the way of its centre in the step, and where that is controlled what the noise made of it.
template <int D>
void Bodies<D>::add_growth(const Particles<D>& particles, const StepRecord<D>& record) {
  const std::vector<int>& directions = bodies_.msd.directions;
  for (std::size_t kind = 0; kind < growth_.size(); ++kind) {
    std::vector<double> way, made, response;
    for (std::size_t b = 0; b < kind_.size(); ++b) {
      if (kind_[b] != kind) continue;
      const double share = 1.0 / static_cast<double>(members_[b].size());
      for (const int c : directions) {
        way.push_back(0.0);
        for (const std::int32_t p : members_[b])
          way.back() += share * record.dt * record.v_mid[index(p)][c];
        if (!growth_[kind].control_is_due()) continue;
        std::vector<Vec<D>> force(record.v_mid.size());
        for (const std::int32_t p : members_[b]) force[index(p)][c] = share;
        const ForceAnswer<D> answer =
            answer_to_force<D>(particles, record, {force}, 0.0, bodies_.control.tolerance);
        made.push_back(record.dt * answer.noise);
        response.push_back(answer.mobility);
      }
    }
    growth_[kind].add(way, made, response);
  }
}

template <int D>
void Bodies<D>::measure(const Clock&, const Particles<D>& particles, const StepRecord<D>& record) {
  std::vector<double> sample(this->average().width(), 0.0);
  members_ = Constituents(particles);
  ParticleLoads<D> noise{std::vector<Vec<D>>(record.start.position.size())};
  if (!record.start.spin.empty()) noise.torque.resize(noise.force.size());
  if (!record.edge_noise.empty()) {
    add_edge_forces<D>(record.start.network, record.edge_noise, noise.force);
    if (!noise.torque.empty())
      add_edge_torques<D>(record.start.network, record.edge_noise, noise.torque);
  }
  add_stage(record.start, record, noise, record.start_weight, sample);
  if (record.has_corrector())
    add_stage(record.corrector, record, noise, 1.0 - record.start_weight, sample);
  add_motion(particles, record, sample);
  particles.ranks().sum(std::span(sample));
  this->add(std::move(sample));
  if (in_time_) follow(particles);
  if (!growth_.empty()) add_growth(particles, record);
  count_fluid(particles, record.start);
}

template <int D>
std::vector<std::string> Bodies<D>::series_columns() const {
  std::vector<std::string> columns;
  const auto add = [&](const std::string& what, std::size_t count) {
    for (std::size_t c = 0; c < count; ++c)
      columns.push_back(count == 1 ? what : fmt::format("{}_{}", what, "xyz"[c]));
  };
  for (const std::string& name : names_) {
    add(name + "_force", D);
    add(name + "_torque", turns);
    add(name + "_velocity", D);
    add(name + "_angular_velocity", turns);
  }
  add("fluid_velocity", D);
  return columns;
}

template <int D>
void Bodies<D>::add_diffusion(const std::string& name, std::size_t kind, Results& results) const {
  if (!in_time_ || scene_.settings().bodies[kind].motion != BodyMotion::free) return;
  if (places_.windows() == 0)
    results.notes.push_back(fmt::format(
        "{}: the measured part is shorter than the window of {}, so no diffusion coefficients",
        this->settings().name, bodies_.msd.window));
  results.scalars.push_back({name + ".diffusion", places_.diffusion().mean(kind),
                             places_.diffusion().standard_error(kind)});
  if (scene_.box().shear) return;  // the flow turns them, which is no diffusion
  // A rod turns about fewer axes than those that were counted.
  const double axes = rotations<D>(scene_.settings().bodies[kind].shape),
               share = rotation_components<D> / axes;
  results.scalars.push_back({name + ".rotational_diffusion", share * turns_.diffusion().mean(kind),
                             share * turns_.diffusion().standard_error(kind)});
}

template <int D>
void Bodies<D>::add_mobility(const std::string& name, std::size_t kind, Results& results) const {
  if (growth_.empty()) return;
  const ModeGrowth& growth = growth_[kind];
  const ModeGrowth::Estimate whole = growth.chi(0), frozen = growth.frozen(0);
  results.scalars.push_back({name + ".mobility", whole.mean, whole.error});
  results.scalars.push_back({name + ".frozen_mobility", frozen.mean, frozen.error});
  if (!scene_.bonds().empty() && kind == 0)
    results.notes.push_back(control_with_bonds(this->settings().name));
  if (growth.samples() == 0) return;
  Table table;
  table.comment = {"mobility by the growth of displacements up to this lag, without the noise"};
  table.columns = {"t", "mobility", "error"};
  for (std::size_t lag = 1; lag <= growth.lags(); ++lag) {
    const ModeGrowth::Estimate at = growth.at_lag(0, lag);
    table.rows.push_back({growth.lag_time(lag), at.mean, at.error});
  }
  results.tables.emplace_back(fmt::format("{}_{}_mobility", this->settings().name, names_[kind]),
                              std::move(table));
}

template <int D>
void Bodies<D>::add_results(Results& results) const {
  const std::string& observer = this->settings().name;
  std::size_t column = 0;
  const auto add = [&](const std::string& what, std::size_t count) {
    for (std::size_t c = 0; c < count; ++c, ++column)
      results.scalars.push_back(
          this->mean_of(column, count == 1 ? what : fmt::format("{}.{}", what, "xyz"[c])));
  };
  for (std::size_t kind = 0; kind < names_.size(); ++kind) {
    const std::string name = observer + "." + names_[kind];
    add(name + ".force", D);
    add(name + ".torque", turns);
    add(name + ".velocity", D);
    add(name + ".angular_velocity", turns);
    add_diffusion(name, kind, results);
    add_mobility(name, kind, results);
    results.scalars.push_back(
        without_error(name + ".exclusion_radius", around_.exclusion_radius(kind)));
  }
  add(observer + ".fluid_velocity", D);
  around_.add_table(observer, "Fluid around the centre of a body", results);
}

template <int D>
void Bodies<D>::save(StateWriter& out) const {
  Observer<D>::save(out);
  around_.save(out);
  places_.save(out, "places_");
  turns_.save(out, "turns_");
  out.write("angle", angle_);
  out.write("orientation", orientation_);
  for (std::size_t kind = 0; kind < growth_.size(); ++kind)
    growth_[kind].save(out, fmt::format("growth_{}_", kind));
}

template <int D>
void Bodies<D>::load(const StateReader& in) {
  Observer<D>::load(in);
  around_.load(in);
  places_.load(in, "places_", kind_.size() * D);
  turns_.load(in, "turns_", kind_.size() * D);
  angle_ = in.read_doubles("angle");
  orientation_ = in.read_doubles("orientation");
  for (std::size_t kind = 0; kind < growth_.size(); ++kind)
    growth_[kind].load(in, fmt::format("growth_{}_", kind));
}

template class Bodies<2>;
template class Bodies<3>;

}  // namespace odpd
