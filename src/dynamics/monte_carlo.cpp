#include "odpd/dynamics/monte_carlo.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/random.h"

namespace odpd {

namespace {
constexpr double wanted_acceptance = 0.4;
constexpr std::int64_t trials_per_tuning = 1000;
}  // namespace

template <int D>
void MonteCarlo<D>::refuse_driving(Dynamics<D>& dynamics, double time) {
  const Particles<D>& particles = dynamics.particles();
  const auto refuse = [](const std::string& what) {
    throw ConfigError("integrator 'monte-carlo' samples equilibrium, and " + what +
                      ", or use integrator.name = \"trapezoidal\"");
  };
  for (std::size_t i = 0; i < particles.position.size(); ++i)
    if (particles.is_known(i) && particles.body_of(i) < 0 &&
        dynamics.surroundings().known_velocity(particles.group[i], time) != Vec<D>{})
      refuse("a moving wall has none: set wall.velocity to zero");
  for (std::size_t b = 0; b < particles.bodies.size(); ++b) {
    const RigidMotion<D> motion = dynamics.surroundings().known_motion(b, time);
    if (particles.bodies[b].known && (motion.velocity != Vec<D>{} || motion.angular != Vec<D>{}))
      refuse("a moving body has none: set its velocity and angular_velocity to zero");
    const RigidLoad<D> load = dynamics.surroundings().body_load(b, time);
    if (load.force != Vec<D>{} || load.torque != Vec<D>{})
      refuse("a body that is pushed has none here: set its force and torque to zero");
  }
  if (dynamics.surroundings().driving_varies())
    refuse(
        "a force that differs from place to place drives a flow: remove body_force.wave and "
        "body_force.region");
  force_.assign(particles.position.size(), Vec<D>{});
  dynamics.surroundings().add_driving_forces(particles, particles.position, time, force_);
  for (int c = 0; c < D; ++c)
    if (dynamics.box().is_periodic(c))
      for (const Vec<D>& f : force_)
        if (f[c] != 0.0)
          refuse(fmt::format(
              "a body force along {}, a periodic direction, has none: set that component of "
              "body_force.force to zero",
              "xyz"[c]));
}

template <int D>
void MonteCarlo<D>::prepare(Dynamics<D>& dynamics) {
  const double kT = dynamics.constants().kT;
  if (!(kT > 0.0))
    throw ConfigError(
        "integrator 'monte-carlo' samples exp(-U/kT) and needs fluid.kT > 0: set it, or use "
        "integrator.name = \"trapezoidal\"");
  refuse_driving(dynamics, 0.0);
  dynamics.evaluate(dynamics.particles().position, 0.0, record_.start);
  const PairNetwork<D>& network = record_.start.network;
  for (std::size_t k = 0; k < network.kT.size(); ++k)
    if (network.kT[k] != kT)
      throw ConfigError(fmt::format(
          "integrator 'monte-carlo' samples one temperature, but there are pairs of kT = {} and of "
          "{}: give all the same, or use integrator.name = \"trapezoidal\"",
          kT, network.kT[k]));
  if (step_ == 0.0) step_ = 0.3 * dynamics.model().cutoff();
  energy_ = std::make_unique<LocalEnergy<D>>(dynamics.box(), dynamics.model(),
                                             dynamics.surroundings(), dynamics.particles());
}

template <int D>
bool MonteCarlo<D>::try_move(Dynamics<D>& dynamics, std::size_t i, const std::array<double, 4>& u) {
  const Box<D>& box = dynamics.box();
  Particles<D>& particles = dynamics.particles();
  Vec<D> r = particles.position[i];
  auto image = particles.image[i];
  for (int c = 0; c < D; ++c) {
    r[c] += step_ * (2.0 * u[index(c)] - 1.0);
    if (!box.is_periodic(c) && (r[c] < 0.0 || r[c] > box.size[c])) return false;
  }
  // A body force acts along bounded directions only, where nothing wraps.
  const double work = dot(force_[i], r - particles.position[i]);
  box.wrap(r, image);
  const auto self = static_cast<std::int32_t>(i);
  const double change = energy_->change({&self, 1}, {&r, 1}) - work;
  if (!(change <= 0.0 || u.back() < std::exp(-change / dynamics.constants().kT))) return false;
  energy_->accept();
  particles.position[i] = r;
  particles.image[i] = image;
  return true;
}

template <int D>
bool MonteCarlo<D>::try_body(Dynamics<D>& dynamics, std::size_t body, const CounterRandom& random,
                             std::int64_t step) {
  const Box<D>& box = dynamics.box();
  Particles<D>& particles = dynamics.particles();
  const RigidBody<D>& b = particles.bodies[body];
  const auto constituents = dynamics.dofs().constituents(body);
  double radius = 0.0;
  for (const Vec<D>& point : b.frame) radius = std::max(radius, norm(point));
  const auto shift = random.uniforms(static_cast<std::uint64_t>(step), 1, body, 0);
  const auto turn = random.uniforms(static_cast<std::uint64_t>(step), 2, body, 0);
  RigidMotion<D> motion;
  for (int c = 0; c < D; ++c) motion.velocity[c] = step_ * (2.0 * shift[index(c)] - 1.0);
  const double angle = std::min(step_ / radius, std::numbers::pi / 2.0);
  for (int c = 0; c < rotation_components<D>; ++c)
    motion.angular[c] = angle * (2.0 * turn[index(c)] - 1.0);
  RigidPose<D> pose = b.pose;
  pose.advance(motion, 1.0, box);
  std::vector<Vec<D>> position(constituents.size());
  std::vector<typename Particles<D>::Image> image(constituents.size());
  double work = 0.0;
  for (std::size_t k = 0; k < constituents.size(); ++k) {
    const auto p = index(constituents[k]);
    place_constituent(b, pose, k, box, position[k], image[k]);
    for (int c = 0; c < D; ++c)
      if (!box.is_periodic(c) && (position[k][c] < 0.0 || position[k][c] > box.size[c]))
        return false;
    work += dot(force_[p], box.separation(position[k], particles.position[p]));
  }
  const double change = energy_->change(constituents, position) - work;
  if (!(change <= 0.0 || turn.back() < std::exp(-change / dynamics.constants().kT))) return false;
  energy_->accept();
  for (std::size_t k = 0; k < constituents.size(); ++k) {
    const auto p = index(constituents[k]);
    particles.position[p] = position[k];
    particles.image[p] = image[k];
  }
  particles.bodies[body].pose = pose;
  return true;
}

template <int D>
void MonteCarlo<D>::sweep(Dynamics<D>& dynamics, std::int64_t step) {
  const PhaseTimer timer(dynamics.phases(), Phase::sweep);
  const Particles<D>& particles = dynamics.particles();
  const CounterRandom random(dynamics.settings().seed, Stream::monte_carlo);
  const Share own = particles.owned();
  std::array<std::int64_t, 2> count{};  // trials and those accepted, of this rank
  energy_->sort_in();
  for (const std::int32_t row : particles.index_of_id()) {
    const auto i = index(row);
    if (!particles.is_free(i)) continue;
    const auto u = random.uniforms(static_cast<std::uint64_t>(step), 0,
                                   static_cast<std::uint64_t>(particles.id[i]), 0);
    const bool moved = try_move(dynamics, i, u);
    if (!own.owns(i)) continue;
    ++count[0];
    if (moved) ++count[1];
  }
  for (std::size_t b = 0; b < index(dynamics.dofs().bodies()); ++b) {
    const bool moved = try_body(dynamics, b, random, step);
    if (own.ranks->rank() > 0) continue;
    ++count[0];
    if (moved) ++count[1];
  }
  trials_ += own.ranks->sum(count[0]);
  accepted_ += own.ranks->sum(count[1]);
}

// Between 0.6 and 1.6 times the step, up to half the box: beyond it nothing is gained where moves are free.
template <int D>
void MonteCarlo<D>::tune(const Box<D>& box) {
  step_ *= 1.0 + acceptance() - wanted_acceptance;
  for (const double edge : box.size.x) step_ = std::min(step_, 0.5 * edge);
  trials_ = accepted_ = 0;
}

template <int D>
const StepRecord<D>& MonteCarlo<D>::step(Dynamics<D>& dynamics, const Clock& clock) {
  if (!energy_) prepare(dynamics);
  record_.step = clock.step;
  record_.dt = clock.dt;
  dynamics.reorder_if_due(clock.step);
  refuse_driving(dynamics, clock.time());
  // As costly as the sweep itself, and of no consequence for it.
  if (clock.sampled) dynamics.evaluate(dynamics.particles().position, clock.time(), record_.start);
  record_.v_mid.assign(dynamics.particles().position.size(), Vec<D>{});
  dynamics.particles().velocity = record_.v_mid;
  sweep(dynamics, clock.step);
  if (clock.step < clock.equilibration_steps && trials_ >= trials_per_tuning) tune(dynamics.box());
  // The report tells the acceptance of the measured part.
  if (clock.step + 1 == clock.equilibration_steps) trials_ = accepted_ = 0;
  return record_;
}

template <int D>
double MonteCarlo<D>::acceptance() const {
  return static_cast<double>(accepted_) / static_cast<double>(std::max<std::int64_t>(trials_, 1));
}

template <int D>
std::string MonteCarlo<D>::summary() const {
  return fmt::format("trial moves of up to {:.4g} per component, {:.1f} % accepted", step_,
                     100.0 * acceptance());
}

template <int D>
void MonteCarlo<D>::save(StateWriter& out) const {
  out.write("step", std::vector<double>{step_});
  out.write("trials", std::vector<std::int64_t>{trials_, accepted_});
}

template <int D>
void MonteCarlo<D>::load(const StateReader& in) {
  step_ = in.read_doubles("step").at(0);
  trials_ = in.read_integers("trials").at(0);
  accepted_ = in.read_integers("trials").at(1);
}

template class MonteCarlo<2>;
template class MonteCarlo<3>;

}  // namespace odpd
