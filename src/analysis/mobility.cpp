#include "odpd/analysis/mobility.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/analysis/frozen.h"
#include "odpd/analysis/observer_keys.h"
#include "odpd/core/index.h"
#include "odpd/particles/constituents.h"

namespace odpd {

namespace {

template <int D>
std::vector<std::string> names_of_movers(const MobilitySettings& mobility, const Scene<D>& scene) {
  std::vector<std::string> names;
  for (const std::size_t k : mobility.bodies) names.push_back(scene.settings().bodies[k].name);
  for (const std::size_t k : mobility.molecules)
    names.push_back(scene.settings().molecules[k].name);
  return names;
}

template <int D>
std::vector<std::string> mobility_columns(const MobilitySettings& mobility, const Scene<D>& scene) {
  std::vector<std::string> columns;
  for (const std::string& name : names_of_movers(mobility, scene)) {
    columns.insert(columns.end(), {name + ".translation", name + ".rotation"});
    if (mobility.collective) columns.push_back(name + ".collective");
    if (mobility.random_loads) continue;
    for (int c = 0; c < D; ++c) columns.push_back(name + ".translation." + "xyz"[c]);
    for (int c = 0; c < rotation_components<D> && rotation_components < D >> 1; ++c)
      columns.push_back(name + ".rotation." + "xyz"[c]);
  }
  return columns;
}

template <int D>
Vec<D> unit_vector(int c) {
  Vec<D> e{};
  e[c] = 1.0;
  return e;
}

// The axis c that a body turns about, among axes that are turned themselves.
Vec<2> turning_axis(const Rotation<2>&, int c) { return unit_vector<2>(c); }
Vec<3> turning_axis(const Rotation<3>& axes, int c) { return axes.turn(unit_vector<3>(c)); }

template <int D>
void load_by_force(std::span<const std::int32_t> particles, const Vec<D>& f,
                   std::vector<Vec<D>>& force) {
  for (const std::int32_t p : particles)
    force[index(p)] += (1.0 / static_cast<double>(particles.size())) * f;
}

double sign(double uniform) { return uniform < 0.5 ? -1.0 : 1.0; }

template <int D>
ParticleLoads<D> no_loads(std::size_t particles) {
  return {std::vector<Vec<D>>(particles), std::vector<Vec<D>>(particles)};
}

}  // namespace

template <int D>
int Mobility<D>::Mover::rotations() const {
  return spins ? rotation_components<D> : odpd::rotations<D>(std::span<const Vec<D>>(arms));
}

// Forces that are a torque and no net force, but on a particle that spins.
template <int D>
bool Mobility<D>::Mover::load_by_torque(const Vec<D>& t, ParticleLoads<D>& loads) const {
  if (spins) {
    // In 2D the second component is nobody's.
    for (int c = 0; c < rotation_components<D>; ++c) loads.torque[index(particles[0])][c] += t[c];
    return true;
  }
  const Vec<D> spin = angular_velocity<D>(arms, t);
  double size = 0.0;
  for (const Vec<D>& a : arms) size += dot(a, a);
  for (std::size_t k = 0; k < arms.size(); ++k)
    loads.force[index(particles[k])] += swing(spin, arms[k]);
  return norm(spin) * size > least_moment * norm(t);
}

// Nothing where the volume of a body is not given, or something holds the fluid.
template <int D>
auto Mobility<D>::weights_of_kinds(const Scene<D>& scene) -> Weights {
  const SceneSettings<D>& s = scene.settings();
  double sites = 0.0, excluded = 0.0;
  for (const BodySettings<D>& b : s.bodies) {
    if (b.excluded_volume <= 0.0) return {};
    sites += static_cast<double>(b.particles());
    excluded += static_cast<double>(b.bodies()) * b.excluded_volume;
  }
  for (const MoleculeSettings<D>& m : s.molecules) {
    if (m.excluded_volume <= 0.0) continue;
    sites += static_cast<double>(m.molecules() * m.beads());
    excluded += static_cast<double>(m.molecules()) * m.excluded_volume;
  }
  if (excluded == 0.0 || !scene.conserves_momentum()) return {};
  const double n =
      (static_cast<double>(scene.particles().size()) - sites) / (s.fluid_volume() - excluded);
  Weights weights;
  for (const BodySettings<D>& b : s.bodies)
    weights.site.push_back(n * b.excluded_volume / static_cast<double>(b.shape.size()));
  for (const MoleculeSettings<D>& m : s.molecules)
    weights.bead.push_back(
        m.excluded_volume > 0.0 ? n * m.excluded_volume / static_cast<double>(m.beads()) : 1.0);
  return weights;
}

template <int D>
Mobility<D>::Mobility(ObserverSettings settings, MobilitySettings mobility, const Scene<D>& scene)
    : Observer<D>(std::move(settings), mobility_columns(mobility, scene)),
      mobility_(std::move(mobility)),
      scene_(scene),
      kind_weight_(weights_of_kinds(scene)),
      beads_(scene),
      random_(scene.settings().seed, Stream::loads) {}

namespace {

// Whose mobility is asked for.
template <int D>
void read_movers(const ObserverEntry<D>& entry, MobilitySettings& mobility) {
  const SceneSettings<D>& s = entry.scene.settings();
  for (std::size_t k = 0; k < s.bodies.size(); ++k)
    if (s.bodies[k].motion == BodyMotion::free) mobility.bodies.push_back(k);
  for (std::size_t k = 0; k < s.molecules.size(); ++k) mobility.molecules.push_back(k);
  std::vector<std::string> names = names_of_movers(mobility, entry.scene);
  if (names.empty())
    entry.config.fail("kind", "the scene has neither a free [[body]] nor a [[molecule]] to load");
  std::vector<std::string> wanted = names;
  if (entry.config.has("of")) wanted = entry.config.texts("of");
  for (const std::string& name : wanted) {
    const auto times = std::count(names.begin(), names.end(), name);
    if (times == 0)
      entry.config.fail("of", fmt::format("no free [[body]] and no [[molecule]] is named '{}': it "
                                          "has {}",
                                          name, fmt::join(names, ", ")));
    if (times > 1)
      entry.config.fail("of", fmt::format("'{}' names a [[body]] and a [[molecule]]: give each a "
                                          "name of its own",
                                          name));
  }
  const auto unwanted = [&](const std::string& name) {
    return std::find(wanted.begin(), wanted.end(), name) == wanted.end();
  };
  std::erase_if(mobility.bodies, [&](std::size_t k) { return unwanted(s.bodies[k].name); });
  std::erase_if(mobility.molecules, [&](std::size_t k) { return unwanted(s.molecules[k].name); });
  if (mobility.bodies.empty() && mobility.molecules.empty())
    entry.config.fail("of", "at least one name is needed");
}

}  // namespace

template <int D>
std::unique_ptr<Observer<D>> Mobility<D>::make(const ObserverEntry<D>& entry) {
  const Config& config = entry.config;
  ObserverSettings settings = entry.settings(50);
  MobilitySettings mobility;
  if (entry.in_time) refuse_frozen(entry);
  read_movers(entry, mobility);
  mobility.random_loads = config.choice("loads", {"unit", "random"}, "unit") == "random";
  for (const char* key : {"sample", "axes"})
    if (mobility.random_loads && config.has(key))
      config.fail(key,
                  "belongs to unit loads: random ones are on all bodies and in all directions at "
                  "once");
  if (!mobility.random_loads) {
    mobility.sample = config.positive_integer("sample", mobility.sample);
    mobility.own_axes = config.choice("axes", {"space", "body"}, "space") == "body";
  }
  if (mobility.own_axes && !mobility.molecules.empty())
    config.fail("axes", "a molecule has no axes of its own: use \"space\", or name bodies in `of`");
  mobility.collective = config.boolean("collective", false);
  mobility.incompressible = read_incompressible(entry);
  mobility.tolerance = read_frozen_tolerance(config);
  return std::make_unique<Mobility<D>>(std::move(settings), std::move(mobility), entry.scene);
}

template <int D>
double Mobility<D>::solves() const {
  const std::size_t kinds = mobility_.bodies.size() + mobility_.molecules.size();
  double solves = mobility_.collective ? static_cast<double>(D * kinds) : 0.0;
  const auto add = [&](std::int64_t count) {
    solves +=
        mobility_.random_loads
            ? 2.0
            : static_cast<double>(std::min(count, mobility_.sample) * (D + rotation_components<D>));
  };
  for (const std::size_t k : mobility_.bodies) add(scene_.settings().bodies[k].bodies());
  for (const std::size_t k : mobility_.molecules) add(scene_.settings().molecules[k].molecules());
  return (mobility_.incompressible ? 1.0 + solves_with_pressure * solves : solves) /
         static_cast<double>(this->settings().every);
}

template <int D>
auto Mobility<D>::movers(const Step& step) const -> std::vector<std::vector<Mover>> {
  const Stage<D>& stage = step.record.start;
  std::vector<std::vector<Mover>> movers;
  const Constituents members(step.particles);
  for (const std::size_t kind : mobility_.bodies) {
    movers.emplace_back();
    for (std::size_t b = 0; b < members.bodies(); ++b) {
      if (scene_.body_kind(b) != kind) continue;
      Mover mover{
          .particles = {members[b].begin(), members[b].end()}, .arms = {}, .axes = {}, .which = b};
      for (const std::int32_t p : members[b]) mover.arms.push_back(stage.arms[index(p)]);
      // The pose is that of the step's end.
      if (mobility_.own_axes)
        mover.axes = best_rotation(step.particles.bodies[b].frame, mover.arms);
      movers.back().push_back(std::move(mover));
    }
  }
  const std::vector<std::int32_t> index_of = step.particles.index_of_id();
  for (const std::size_t kind : mobility_.molecules) {
    movers.emplace_back();
    std::uint64_t which = members.bodies();
    for (const Molecule& m : scene_.molecules()) {
      ++which;
      if (m.kind != kind) continue;
      Mover mover{
          .particles = {}, .arms = beads_.of(m, stage, index_of), .axes = {}, .which = which};
      Vec<D> centre{};
      for (const Vec<D>& a : mover.arms)
        centre += (1.0 / static_cast<double>(mover.arms.size())) * a;
      for (std::size_t k = 0; k < mover.arms.size(); ++k) {
        mover.arms[k] -= centre;
        mover.particles.push_back(index_of[index(m.first) + k]);
      }
      mover.spins = mover.particles.size() == 1 && step.particles.spins(index(mover.particles[0]));
      movers.back().push_back(std::move(mover));
    }
  }
  return movers;
}

template <int D>
auto Mobility<D>::chosen(std::vector<Mover> movers, std::uint64_t step) const
    -> std::vector<Mover> {
  const std::size_t wanted = index(mobility_.sample);
  if (movers.size() <= wanted) return movers;
  const auto rank = [&](const Mover& m) { return random_.uniforms(step, 0, m.which, 0)[0]; };
  std::sort(movers.begin(), movers.end(),
            [&](const Mover& a, const Mover& b) { return rank(a) < rank(b); });
  movers.resize(wanted);
  return movers;
}

template <int D>
std::vector<double> Mobility<D>::weights(const Particles<D>& particles) const {
  std::vector<double> weight(particles.size(), 1.0);
  for (std::size_t i = 0; i < weight.size(); ++i)
    if (const std::int32_t b = particles.body_of(i); b >= 0)
      weight[i] = kind_weight_.site[scene_.body_kind(index(b))];
  const std::vector<std::int32_t> index_of = particles.index_of_id();
  for (const Molecule& m : scene_.molecules())
    for (std::int64_t k = 0; k < scene_.settings().molecules[m.kind].beads(); ++k)
      weight[index(index_of[index(m.first + k)])] = kind_weight_.bead[m.kind];
  return weight;
}

template <int D>
double Mobility<D>::answer(const Step& step, ParticleLoads<D> loads) const {
  std::vector<Vec<D>>& force = loads.force;
  if (!kind_weight_.site.empty() || !kind_weight_.bead.empty()) {
    const std::vector<double> weight = weights(step.particles);
    const Share own = step.particles.owned();
    std::array<double, D + 1> sums{};
    for (auto i = index(own.first); i < index(own.end(std::ssize(force))); ++i) {
      for (int c = 0; c < D; ++c) sums[index(c)] += force[i][c];
      sums[D] += weight[i];
    }
    step.particles.ranks().sum(std::span(sums));
    for (std::size_t i = 0; i < force.size(); ++i)
      for (int c = 0; c < D; ++c) force[i][c] -= weight[i] * sums[index(c)] / sums[D];
  }
  return answer_to_force(step.particles, step.record, loads, scene_.settings().zeta_0,
                         mobility_.tolerance, step.pressure)
      .mobility;
}

template <int D>
auto Mobility<D>::to_unit_loads(const Step& step, const std::vector<Mover>& movers) const
    -> Answers {
  constexpr int turns = rotation_components<D>;
  Answers means;
  means.components.assign(D + turns, 0.0);
  const double share = 1.0 / static_cast<double>(movers.size());
  double axes = 0.0;
  for (const Mover& mover : movers) {
    for (int c = 0; c < D; ++c) {
      ParticleLoads<D> loads = no_loads<D>(step.record.v_mid.size());
      load_by_force(std::span(mover.particles), mover.axes.turn(unit_vector<D>(c)), loads.force);
      const double mobility = answer(step, loads);
      means.components[index(c)] += share * mobility;
      means.translation += share / D * mobility;
    }
    const int own = mover.rotations();
    axes += own;
    for (int c = 0; c < turns; ++c) {
      ParticleLoads<D> loads = no_loads<D>(step.record.v_mid.size());
      double& component = means.components[index(D + c)];
      if (own == 0 || !mover.load_by_torque(turning_axis(mover.axes, c), loads)) {
        // About its line a rod does not turn: e . mu e is 0 where e comes to lie along it, and of its own axis there is none.
        if (own == 0 || mobility_.own_axes) component = std::nan("");
        continue;
      }
      const double mobility = answer(step, loads);
      component += share * mobility;
      means.rotation += mobility;
    }
  }
  means.rotation /= axes;
  return means;
}

template <int D>
auto Mobility<D>::to_random_loads(const Step& step, const std::vector<Mover>& movers) const
    -> Answers {
  const std::size_t n = step.record.v_mid.size();
  ParticleLoads<D> forces = no_loads<D>(n), torques = no_loads<D>(n);
  double axes = 0.0;
  const auto signs = [&](std::uint64_t use, const Mover& mover) {
    const auto u =
        random_.uniforms(static_cast<std::uint64_t>(step.record.step), use, mover.which, 0);
    Vec<D> z;
    for (std::size_t c = 0; c < D; ++c) z.x[c] = sign(u[c]);
    return z;
  };
  for (const Mover& mover : movers) {
    load_by_force(std::span(mover.particles), signs(1, mover), forces.force);
    const int own = mover.rotations();
    axes += own;
    if (own > 0) mover.load_by_torque(signs(2, mover), torques);
  }
  return {.translation = answer(step, forces) / static_cast<double>(D * movers.size()),
          .rotation = axes > 0.0 ? answer(step, torques) / axes : std::nan(""),
          .components = {}};
}

template <int D>
double Mobility<D>::to_one_force_on_all(const Step& step, const std::vector<Mover>& movers) const {
  double sum = 0.0;
  for (int c = 0; c < D; ++c) {
    ParticleLoads<D> loads = no_loads<D>(step.record.v_mid.size());
    for (const Mover& mover : movers)
      load_by_force(std::span(mover.particles), unit_vector<D>(c), loads.force);
    sum += answer(step, loads);
  }
  return sum / static_cast<double>(D * movers.size());
}

template <int D>
void Mobility<D>::measure(const Clock&, const Particles<D>& particles,
                          const StepRecord<D>& record) {
  const std::optional<FrozenPressure<D>> pressure =
      pressure_on<D>(particles, record, scene_, mobility_.incompressible, mobility_.tolerance);
  const Step step{particles, record, pressure ? &*pressure : nullptr};
  std::vector<double> sample;
  for (const std::vector<Mover>& all : movers(step)) {
    const Answers answers =
        mobility_.random_loads
            ? to_random_loads(step, all)
            : to_unit_loads(step, chosen(all, static_cast<std::uint64_t>(record.step)));
    sample.push_back(answers.translation);
    sample.push_back(answers.rotation);
    if (mobility_.collective) sample.push_back(to_one_force_on_all(step, all));
    // The one axis of 2D is told already.
    const std::size_t told = answers.components.size() - (rotation_components<D> == 1 ? 1 : 0);
    for (std::size_t c = 0; !answers.components.empty() && c < told; ++c)
      sample.push_back(answers.components[c]);
  }
  this->add(std::move(sample));
}

template class Mobility<2>;
template class Mobility<3>;

}  // namespace odpd
