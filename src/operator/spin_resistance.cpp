#include "odpd/operator/spin_resistance.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "odpd/core/error.h"
#include "odpd/core/parallel.h"
#include "odpd/core/room.h"
#include "small_blocks.h"

namespace odpd {

template <int D>
void SpinResistance<D>::rebuild(const PairNetwork<D>& network, const DofMap<D>& dofs,
                                const Particles<D>& particles, std::span<const Vec<D>> positions,
                                std::span<const Vec<D>> arms, const Shifts& shifts,
                                double stiffness_time, double bond_time) {
  velocities_.rebuild(network, dofs, particles, positions, arms, shifts.inertia + shifts.drag,
                      stiffness_time, bond_time);
  dofs_ = dofs.any_spin() ? &dofs : nullptr;
  length_.clear();
  null_motions_.clear();
  if (dofs_ == nullptr) return;
  with_bodies_ = dofs.bodies() > 0;
  for (const std::int32_t p : dofs.spin_particles())
    length_.push_back(particles.spin_of_species[index(particles.species[index(p)])].lever_radius);
  const auto mobile = index(dofs.mobile());
  spin_of_.resize(mobile);
  for (std::size_t row = 0; row < mobile; ++row)
    spin_of_[row] = dofs.spin_of(index(dofs.particle_of(row)));
  member_of_.assign(with_bodies_ ? mobile : 0, -1);
  if (with_bodies_)
    for (std::size_t k = 0; k < velocities_.map().rows().size(); ++k)
      member_of_[index(velocities_.map().rows()[k])] = static_cast<std::int64_t>(k);
  collect_links(network, dofs);
  sum_diagonal(dofs, shifts.inertia);
  check_spins(dofs, particles);
  find_null_motions();
}

template <int D>
void SpinResistance<D>::collect_links(const PairNetwork<D>& network, const DofMap<D>& dofs) {
  const auto seen = [&](std::size_t k) {
    return !network.lever_i.empty() && network.zeta_perp[k] > 0.0 &&
           network.lever_i[k] + network.lever_j[k] > 0.0;
  };
  start_.assign(index(dofs.mobile()) + 1, 0);
  parallel_for(dofs.mobile(), [&](std::int64_t row) {
    for (const std::int32_t edge : network.edges_of(dofs.particle_of(index(row))))
      if (seen(index(edge))) ++start_[index(row) + 1];
  });
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  resize_afresh(links_, index(start_.back()));
  parallel_for(dofs.mobile(), [&](std::int64_t row) {
    const std::int32_t particle = dofs.particle_of(index(row));
    Link* link = links_.data() + start_[index(row)];
    for (const std::int32_t edge : network.edges_of(particle)) {
      const auto k = index(edge);
      if (!seen(k)) continue;
      const bool first = network.i[k] == particle;
      link->other = dofs.mobile_of(index(first ? network.j[k] : network.i[k]));
      link->zeta_perp = network.zeta_perp[k];
      link->own = first ? network.lever_i[k] : network.lever_j[k];
      link->theirs = first ? network.lever_j[k] : network.lever_i[k];
      link->e = first ? network.e[k] : -1.0 * network.e[k];
      ++link;
    }
  });
}

template <int D>
void SpinResistance<D>::sum_diagonal(const DofMap<D>& dofs, double inertia) {
  diagonal_.assign(length_.size(), Block{});
  spin_shift_.resize(length_.size());
  parallel_for(dofs.mobile(), [&](std::int64_t mobile) {
    const std::int32_t spin = spin_of_[index(mobile)];
    if (spin < 0) return;
    const auto s = index(spin);
    Block& block = diagonal_[s];
    const double scale = 1.0 / (length_[s] * length_[s]);
    for (const Link& link : links(index(mobile))) {
      const Block turn = cross_matrix<D>(link.e);
      const Block square = product_of<D>(turn, turn, true);
      for (std::size_t k = 0; k < D * D; ++k)
        block[k] += scale * link.zeta_perp * link.own * link.own * square[k];
    }
    spin_shift_[s] = scale * inertia * dofs.moments()[s];
    for (std::size_t c = 0; c < turns; ++c) block[c * D + c] += spin_shift_[s];
    for (auto c = turns; c < D; ++c) block[c * D + c] = 1.0;
  });
}

template <int D>
auto SpinResistance<D>::particle_block(std::size_t row) const -> ParticleBlock {
  constexpr std::size_t freedoms = 2 * D;
  ParticleBlock m{};
  const auto& velocity = velocities_.mobile().diagonal()[row];
  const auto spin = index(spin_of_[row]);
  for (std::size_t r = 0; r < D; ++r)
    for (std::size_t c = 0; c < D; ++c) {
      m[r * freedoms + c] = velocity[r * D + c];
      m[(D + r) * freedoms + D + c] = diagonal_[spin][r * D + c];
    }
  for (const Link& link : links(row)) {
    const Block turn = cross_matrix<D>(link.e);
    for (std::size_t r = 0; r < D; ++r)
      for (std::size_t c = 0; c < D; ++c) {
        const double entry = link.zeta_perp * link.own / length_[spin] * turn[r * D + c];
        m[r * freedoms + D + c] += entry;
        m[(D + c) * freedoms + r] += entry;
      }
  }
  return m;
}

template <int D>
void SpinResistance<D>::check_spins(const DofMap<D>& dofs, const Particles<D>& particles) const {
  // Below this a block inverse would amplify rounding beyond any tolerance in use.
  constexpr double singular = 1e-12;
  constexpr std::size_t freedoms = 2 * D;
  std::atomic<std::int64_t> first{dofs.mobile()};
  parallel_for(dofs.mobile(), [&](std::int64_t mobile) {
    if (spin_of_[index(mobile)] < 0) return;
    ParticleBlock block = particle_block(index(mobile));
    // With a unit diagonal, as the unit of a spin is arbitrary.
    std::array<double, freedoms> root;
    bool loose = false;
    for (std::size_t c = 0; c < freedoms; ++c) {
      root[c] = std::sqrt(block[c * freedoms + c]);
      loose = loose || !(root[c] > 0.0);
    }
    for (std::size_t r = 0; r < freedoms && !loose; ++r)
      for (std::size_t c = 0; c < freedoms; ++c) block[r * freedoms + c] /= root[r] * root[c];
    if (loose || relative_determinant<2 * D>(block.data()) <= singular) lower(first, mobile);
  });
  if (first == dofs.mobile()) return;
  const std::int32_t p = dofs.particle_of(index(first.load()));
  throw SolverError(
      fmt::format(
          "particle {} can spin, or roll along its neighbours, without friction: too few of these, "
          "{}, "
          "resist it across the line of centres (gamma_perp), and it has no inertia that would. "
          "Cures: a moment of inertia (fluid.mass and a species' moment), a higher density, or a "
          "larger cutoff",
          particles.id[index(p)], links(index(first.load())).size()),
      SolverError::Cause::singular);
}

// W of a motion u = W x x by the links along which it moves something.
template <int D>
Vec<D> SpinResistance<D>::turning_of(std::span<const double> u) const {
  const Resistance<D>& mobile = velocities_.mobile();
  constexpr int parts = rotation_components<D>;
  Eigen::Matrix<double, parts, parts> square = Eigen::Matrix<double, parts, parts>::Zero();
  Eigen::Matrix<double, parts, 1> moment = Eigen::Matrix<double, parts, 1>::Zero();
  for (std::size_t row = 0; row < index(mobile.nodes()); ++row)
    for (const auto& link : mobile.links(row)) {
      const Vec<D> here = vector_at<D>(u, row), there = vector_at<D>(u, index(link.node));
      if (!mobile.ties(link) || (here == Vec<D>{} && there == Vec<D>{})) continue;
      const Vec<D> d =
          mobile.box().separation(mobile.position(row), mobile.position(index(link.node)));
      const Vec<D> of_slip = torque(d, here - there);
      for (int a = 0; a < parts; ++a) {
        Vec<D> unit{};
        unit[a] = 1.0;
        const Vec<D> of_turn = torque(d, swing(unit, d));
        moment(a) += of_slip[a];
        for (int b = 0; b < parts; ++b) square(b, a) += of_turn[b];
      }
    }
  const Eigen::Matrix<double, parts, 1> w = square.ldlt().solve(moment);
  Vec<D> found{};
  for (int c = 0; c < parts; ++c) found[c] = w(c);
  return found;
}

// What holds a cluster by few links with friction across lets it roll about these, which is no motion of this kind.
template <int D>
void SpinResistance<D>::refuse_resisted(const std::vector<double>& motion) const {
  constexpr double none = 1e-9;
  std::vector<double> met(motion.size()), blocks(motion.size() * D);
  apply(motion, met);
  block_diagonal(blocks);
  double most = 0.0;
  for (std::size_t k = 0; k < motion.size(); ++k)
    most += blocks[k * D + k % D] * motion[k] * motion[k];
  if (inner_product(motion, met) <= none * most) return;
  throw SolverError(
      fmt::format("a group of particles hangs on particles of known velocity by so few links with "
                  "friction across them that it may roll about these without friction, so R may be "
                  "singular. Cures: {}, or mass (fluid.mass) and a species' moment",
                  drag_cure),
      SolverError::Cause::singular);
}

template <int D>
void SpinResistance<D>::find_null_motions() {
  const Resistance<D>& mobile = velocities_.mobile();
  for (const std::vector<double>& u : velocities_.system().null_motions()) {
    std::vector<double> motion(index(size()), 0.0);
    std::copy(u.begin(), u.end(), motion.begin() + spins() * D);
    std::span<const double> v = u;
    if (with_bodies_) {
      velocity_.resize(index(mobile.nodes()) * D);
      velocities_.to_particles(u, velocity_);
      v = velocity_;
    }
    const Vec<D> w = turning_of(v);
    const auto moves = [&](std::size_t row) { return vector_at<D>(v, row) != Vec<D>{}; };
    for (std::size_t row = 0; row < spin_of_.size(); ++row) {
      if (spin_of_[row] < 0) continue;
      const auto around = mobile.links(row);
      if (!moves(row) && std::none_of(around.begin(), around.end(),
                                      [&](const auto& link) { return moves(index(link.node)); }))
        continue;
      const auto s = index(spin_of_[row]);
      for (std::size_t c = 0; c < D; ++c) motion[s * D + c] = length_[s] * w.x[c];
    }
    for (const std::vector<double>& before : null_motions_) {
      const double part = inner_product(before, motion);
      for (std::size_t k = 0; k < motion.size(); ++k) motion[k] -= part * before[k];
    }
    const double size = norm(motion);
    for (double& value : motion) value /= size;
    refuse_resisted(motion);
    null_motions_.push_back(std::move(motion));
  }
}

template <int D>
void SpinResistance<D>::scale_load(std::span<double> load) const {
  if (load.empty()) return;
  parallel_for(spins(), [&](std::int64_t spin) {
    for (std::size_t c = 0; c < D; ++c) load[index(spin) * D + c] /= length_[index(spin)];
  });
  velocities_.scale_load(of_velocities(load));
}

template <int D>
void SpinResistance<D>::scale_velocity(std::span<double> q) const {
  parallel_for(spins(), [&](std::int64_t spin) {
    for (std::size_t c = 0; c < D; ++c) q[index(spin) * D + c] *= length_[index(spin)];
  });
  velocities_.scale_velocity(of_velocities(q));
}

template <int D>
void SpinResistance<D>::unscale_velocity(std::span<double> y) const {
  parallel_for(spins(), [&](std::int64_t spin) {
    for (std::size_t c = 0; c < D; ++c) y[index(spin) * D + c] /= length_[index(spin)];
  });
  velocities_.unscale_velocity(of_velocities(y));
}

template <int D>
void SpinResistance<D>::spins_of(std::span<const double> x, std::vector<Vec<D>>& w) const {
  const std::span<const double> nodes = of_velocities(x);
  w.resize(spin_of_.size());
  parallel_for(std::ssize(spin_of_), [&](std::int64_t mobile) {
    const auto row = index(mobile);
    w[row] = Vec<D>{};
    if (spin_of_[row] >= 0) {
      const auto s = index(spin_of_[row]);
      for (std::size_t c = 0; c < turns; ++c) w[row].x[c] = x[s * D + c] / length_[s];
    } else if (is_constituent(row)) {
      const std::size_t b = velocities_.body_of(row);
      w[row] = velocities_.map()
                   .motion(b, &nodes[velocities_.linear_node(b) * D], &nodes[b * D])
                   .angular;
    }
  });
}

template <int D>
void SpinResistance<D>::apply(std::span<const double> x, std::span<double> y) const {
  const auto mobile = std::ssize(spin_of_);
  const std::span<const double> x_v = of_velocities(x);
  velocities_.system().apply(x_v, of_velocities(y));
  std::span<const double> v = x_v;
  if (with_bodies_) {
    resize_afresh(velocity_, index(mobile) * D);
    velocities_.to_particles(x_v, velocity_);
    v = velocity_;
  }
  spins_of(x, spin_);
  resize_afresh(force_, index(mobile) * D);
  torque_.resize(index(mobile));
  parallel_for(mobile, [&](std::int64_t particle) {
    const auto row = index(particle);
    const Vec<D> own = vector_at<D>(v, row);
    Vec<D> force{}, moment{};
    for (const Link& link : links(row)) {
      Vec<D> turning = link.own * spin_[row], slip = own;
      if (link.other >= 0) {
        turning += link.theirs * spin_[index(link.other)];
        slip -= vector_at<D>(v, index(link.other));
      }
      const Vec<D> s = -link.zeta_perp * swing(turning, link.e);
      force += s;
      moment -= link.own * torque(link.e, link.zeta_perp * slip + s);
    }
    for (std::size_t c = 0; c < D; ++c) force_[row * D + c] = force.x[c];
    torque_[row] = moment;
    if (spin_of_[row] < 0) return;
    const auto s = index(spin_of_[row]);
    for (std::size_t c = 0; c < D; ++c) {
      const bool used = c < turns;
      const double shift = used ? spin_shift_[s] : 1.0;
      y[s * D + c] = (used ? moment.x[c] / length_[s] : 0.0) + shift * x[s * D + c];
    }
  });
  const std::span<double> y_v = of_velocities(y);
  if (!with_bodies_) {
    parallel_for(mobile * D, [&](std::int64_t k) { y_v[index(k)] += force_[index(k)]; });
    return;
  }
  load_.resize(y_v.size());
  velocities_.from_particles(force_, load_);
  parallel_for(std::ssize(load_), [&](std::int64_t k) { y_v[index(k)] += load_[index(k)]; });
  const RigidMap<D>& map = velocities_.map();
  parallel_blocks(map.bodies(), [&](std::int64_t body) {
    const auto b = index(body);
    RigidLoad<D> load;
    for (auto member = index(map.begin(b)); member < index(map.end(b)); ++member)
      load.torque += torque_[index(map.rows()[member])];
    Vec<D> linear{}, angular{};
    map.load(b, load, linear.x.data(), angular.x.data());
    for (std::size_t c = 0; c < D; ++c) y_v[b * D + c] += angular.x[c];
  });
}

template <int D>
void SpinResistance<D>::block_diagonal(std::span<double> blocks) const {
  for (std::size_t s = 0; s < diagonal_.size(); ++s)
    std::copy(diagonal_[s].begin(), diagonal_[s].end(), &blocks[s * D * D]);
  const std::span<double> of_nodes = blocks.subspan(index(spins()) * D * D);
  velocities_.system().block_diagonal(of_nodes);
  if (!with_bodies_) return;
  // No edges inside a body: what is added to its angular block are the spins of its own constituents.
  const RigidMap<D>& map = velocities_.map();
  parallel_blocks(map.bodies(), [&](std::int64_t body) {
    const auto b = index(body);
    double* const block = &of_nodes[b * D * D];
    for (auto member = index(map.begin(b)); member < index(map.end(b)); ++member) {
      const Block lever = velocities_.lever(b, member);
      for (const Link& link : links(index(map.rows()[member]))) {
        const Block s = product_of<D>(cross_matrix<D>(link.e), map.turn(b), false);
        const Block both = product_of<D>(lever, s, true), square = product_of<D>(s, s, true);
        for (std::size_t r = 0; r < D; ++r)
          for (std::size_t c = 0; c < D; ++c)
            block[r * D + c] += link.zeta_perp * link.own *
                                (both[r * D + c] + both[c * D + r] + link.own * square[r * D + c]);
      }
    }
  });
}

template class SpinResistance<2>;
template class SpinResistance<3>;

}  // namespace odpd
