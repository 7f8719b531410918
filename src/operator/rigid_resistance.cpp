#include "odpd/operator/rigid_resistance.h"

#include <algorithm>

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/core/room.h"
#include "small_blocks.h"

namespace odpd {

template <int D>
void RigidResistance<D>::rebuild(const PairNetwork<D>& network, const DofMap<D>& dofs,
                                 const Particles<D>& particles, std::span<const Vec<D>> positions,
                                 std::span<const Vec<D>> arms, double shift, double stiffness_time,
                                 double bond_time) {
  mobile_.rebuild(network, dofs, particles, positions, shift, stiffness_time, bond_time, arms);
  dofs_ = dofs.bodies() > 0 ? &dofs : nullptr;
  if (dofs_ == nullptr) return;
  map_.rebuild(dofs, arms);
  node_.resize(index(dofs.mobile()));
  const std::span<const std::int32_t> free = dofs.free_particles();
  parallel_for(std::ssize(free), [&](std::int64_t k) {
    node_[index(dofs.mobile_of(index(free[index(k)])))] =
        static_cast<std::int32_t>(dofs.free_node(index(k)));
  });
  root_mass_.resize(index(dofs.bodies()));
  parallel_for(dofs.bodies(), [&](std::int64_t body) {
    const auto b = index(body);
    root_mass_[b] = 1.0 / map_.inverse_root_mass(b);
    for (auto member = map_.begin(b); member < map_.end(b); ++member) {
      const auto row = index(map_.rows()[index(member)]);
      node_[row] = -static_cast<std::int32_t>(body) - 1;
    }
  });
  null_motions_.clear();
  for (const std::vector<double>& motion : mobile_.null_motions()) {
    null_motions_.emplace_back(index(size()));
    from_particles(motion, null_motions_.back());
  }
}

template <int D>
Translations RigidResistance<D>::translations() const {
  Translations t = dofs_->translations();
  t.weights = root_mass_;
  return t;
}

/// v = P y on the mobile particles.
template <int D>
void RigidResistance<D>::to_particles(std::span<const double> y, std::span<double> v) const {
  parallel_for(std::ssize(node_), [&](std::int64_t row) {
    const std::int32_t node = node_[index(row)];
    if (node < 0) return;
    for (std::size_t c = 0; c < D; ++c) v[index(row) * D + c] = y[index(node) * D + c];
  });
  parallel_blocks(map_.bodies(), [&](std::int64_t body) {
    const auto b = index(body);
    const RigidMotion<D> motion = map_.motion(b, &y[linear_node(b) * D], &y[b * D]);
    for (auto member = index(map_.begin(b)); member < index(map_.end(b)); ++member) {
      const Vec<D> u = motion.velocity + swing(motion.angular, map_.arms()[member]);
      for (std::size_t c = 0; c < D; ++c) v[index(map_.rows()[member]) * D + c] = u.x[c];
    }
  });
}

/// y = P^T f, with the constituents of all ranks.
template <int D>
void RigidResistance<D>::from_particles(std::span<const double> f, std::span<double> y) const {
  const Share own = mobile_.share();
  parallel_for(std::ssize(node_), [&](std::int64_t row) {
    const std::int32_t node = node_[index(row)];
    if (node < 0) return;
    for (std::size_t c = 0; c < D; ++c) y[index(node) * D + c] = f[index(row) * D + c];
  });
  parallel_blocks(map_.bodies(), [&](std::int64_t body) {
    const auto b = index(body);
    RigidLoad<D> load;
    for (auto member = index(map_.begin(b)); member < index(map_.end(b)); ++member) {
      const auto row = index(map_.rows()[member]);
      if (!own.owns(row)) continue;
      const Vec<D> force = vector_at<D>(f, row);
      load.force += force;
      load.torque += torque(map_.arms()[member], force);
    }
    map_.load(b, load, &y[linear_node(b) * D], &y[b * D]);
  });
  const std::size_t of_bodies = index(map_.bodies()) * D;
  own.ranks->sum(y.first(of_bodies));
  own.ranks->sum(y.last(of_bodies));
}

template <int D>
template <class Change>
void RigidResistance<D>::for_each_body(std::span<double> x, const Change& change) const {
  if (dofs_ == nullptr) return;
  parallel_for(map_.bodies(), [&](std::int64_t body) {
    const auto b = index(body);
    change(b, &x[linear_node(b) * D], &x[b * D]);
  });
}

template <int D>
void RigidResistance<D>::scale_load(std::span<double> load) const {
  for_each_body(load, [&](std::size_t b, double* linear, double* angular) {
    map_.load(b, {vector_at<D>({linear, D}, 0), vector_at<D>({angular, D}, 0)}, linear, angular);
  });
}

template <int D>
void RigidResistance<D>::scale_velocity(std::span<double> q) const {
  for_each_body(q, [&](std::size_t b, double* linear, double* angular) {
    map_.unknowns(b, {vector_at<D>({linear, D}, 0), vector_at<D>({angular, D}, 0)}, linear,
                  angular);
  });
}

template <int D>
void RigidResistance<D>::unscale_velocity(std::span<double> y) const {
  for_each_body(y, [&](std::size_t b, double* linear, double* angular) {
    const RigidMotion<D> motion = map_.motion(b, linear, angular);
    std::copy_n(motion.velocity.x.begin(), D, linear);
    std::copy_n(motion.angular.x.begin(), D, angular);
  });
}

template <int D>
void RigidResistance<D>::apply(std::span<const double> x, std::span<double> y) const {
  resize_afresh(velocity_, node_.size() * D);
  resize_afresh(force_, node_.size() * D);
  to_particles(x, velocity_);
  mobile_.apply(velocity_, force_);
  from_particles(force_, y);
  parallel_for(map_.bodies(), [&](std::int64_t body) {
    const auto b = index(body);
    for (std::size_t row = 0; row < D; ++row)
      for (std::size_t col = 0; col < D; ++col)
        y[b * D + row] += map_.unused(b)[row * D + col] * x[b * D + col];
  });
}

template <int D>
auto RigidResistance<D>::lever(std::size_t b, std::size_t member) const ->
    typename Resistance<D>::Block {
  typename Resistance<D>::Block map;
  for (std::size_t c = 0; c < D; ++c) {
    Vec<D> w;
    for (std::size_t k = 0; k < D; ++k) w.x[k] = map_.turn(b)[k * D + c];
    const Vec<D> v = swing(w, map_.arms()[member]);
    for (std::size_t k = 0; k < D; ++k) map[k * D + c] = v.x[k];
  }
  return map;
}

template <int D>
void RigidResistance<D>::body_blocks(std::vector<double>& blocks) const {
  constexpr std::size_t all = 2 * D, size = all * all;
  blocks.assign(index(map_.bodies()) * size, 0.0);
  const Share own = mobile_.share();
  // No edges inside a body: its constituents' diagonal blocks are all that falls on its own.
  parallel_blocks(map_.bodies(), [&](std::int64_t body) {
    const auto b = index(body);
    double* const block = &blocks[b * size];
    for (auto member = index(map_.begin(b)); member < index(map_.end(b)); ++member) {
      const auto row = index(map_.rows()[member]);
      if (!own.owns(row)) continue;
      const auto turn = lever(b, member);
      double map[D][all];
      for (std::size_t k = 0; k < D; ++k)
        for (std::size_t c = 0; c < D; ++c) {
          map[k][c] = turn[k * D + c];
          map[k][D + c] = k == c ? map_.inverse_root_mass(b) : 0.0;
        }
      for (std::size_t k = 0; k < D; ++k) {
        double pull[all] = {};
        for (std::size_t l = 0; l < D; ++l)
          for (std::size_t c = 0; c < all; ++c)
            pull[c] += mobile_.diagonal()[row][k * D + l] * map[l][c];
        for (std::size_t r = 0; r < all; ++r)
          for (std::size_t c = 0; c < all; ++c) block[r * all + c] += map[k][r] * pull[c];
      }
    }
  });
  own.ranks->sum(std::span(blocks));
  for (std::size_t b = 0; b < index(map_.bodies()); ++b)
    for (std::size_t row = 0; row < D; ++row)
      for (std::size_t col = 0; col < D; ++col)
        blocks[b * size + row * all + col] += map_.unused(b)[row * D + col];
}

template <int D>
void RigidResistance<D>::block_diagonal(std::span<double> blocks) const {
  parallel_for(std::ssize(node_), [&](std::int64_t row) {
    const std::int32_t node = node_[index(row)];
    if (node < 0) return;
    const auto& own = mobile_.diagonal()[index(row)];
    std::copy(own.begin(), own.end(), &blocks[index(node) * D * D]);
  });
  std::vector<double> whole;
  body_blocks(whole);
  for (std::size_t b = 0; b < index(map_.bodies()); ++b)
    for (std::size_t row = 0; row < D; ++row) {
      const double* const angular = &whole[(b * 2 * D + row) * 2 * D];
      const double* const linear = angular + 2 * D * D + D;
      std::copy_n(angular, D, &blocks[(b * D + row) * D]);
      std::copy_n(linear, D, &blocks[(linear_node(b) * D + row) * D]);
    }
}

template <int D>
const BlockCsr& RigidResistance<D>::matrix() const {
  if (matrix_generation_ == generation()) return matrix_;
  using Block = typename Resistance<D>::Block;
  const BlockCsr& inner = mobile_.matrix();
  BlockCsr m;
  m.block = D;
  m.rows = static_cast<std::int32_t>(nodes());
  m.start.push_back(0);
  Block unit{};
  for (std::size_t c = 0; c < D; ++c) unit[c * D + c] = 1.0;
  std::vector<std::int32_t> member_of(node_.size());  // numbers of constituents in map_
  for (std::size_t member = 0; member < map_.rows().size(); ++member)
    member_of[index(map_.rows()[member])] = static_cast<std::int32_t>(member);
  // The row of a node: blocks by column, `slot` says where a column stands among them (-1: not yet).
  std::vector<std::int32_t> slot(index(nodes()), -1);
  std::vector<std::pair<std::int32_t, Block>> blocks;
  const auto at = [&](std::size_t column) -> double* {
    if (slot[column] < 0) {
      slot[column] = static_cast<std::int32_t>(blocks.size());
      blocks.push_back({static_cast<std::int32_t>(column), {}});
    }
    return blocks[index(slot[column])].second.data();
  };
  // left^T R of one mobile particle, by those that its neighbours stand for.
  const auto add_row = [&](std::size_t row, const Block& left) {
    for (auto k = index(inner.start[row]); k < index(inner.start[row + 1]); ++k) {
      const auto other = index(inner.column[k]);
      const double* const value = &inner.value[k * D * D];
      if (node_[other] >= 0) {
        add_triple_product<D>(left.data(), value, unit.data(), at(index(node_[other])));
        continue;
      }
      const auto b = index(-node_[other] - 1);
      Block shift = unit;
      for (double& entry : shift) entry *= map_.inverse_root_mass(b);
      const Block turn = lever(b, index(member_of[other]));
      add_triple_product<D>(left.data(), value, shift.data(), at(linear_node(b)));
      add_triple_product<D>(left.data(), value, turn.data(), at(b));
    }
  };
  const auto finish = [&] {
    std::sort(blocks.begin(), blocks.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [column, block] : blocks) {
      m.column.push_back(column);
      m.value.insert(m.value.end(), block.begin(), block.end());
      slot[index(column)] = -1;
    }
    m.start.push_back(static_cast<std::int32_t>(m.column.size()));
    blocks.clear();
  };
  const auto bodies = index(map_.bodies());
  const auto add_body = [&](std::size_t b, bool angular) {
    Block shift = unit;
    for (double& entry : shift) entry *= map_.inverse_root_mass(b);
    for (auto member = index(map_.begin(b)); member < index(map_.end(b)); ++member)
      add_row(index(map_.rows()[member]), angular ? lever(b, member) : shift);
    if (angular)
      for (std::size_t k = 0; k < D * D; ++k) at(b)[k] += map_.unused(b)[k];
    finish();
  };
  for (std::size_t b = 0; b < bodies; ++b) add_body(b, true);
  for (std::size_t row = 0; row < node_.size(); ++row)
    if (node_[row] >= 0) {
      add_row(row, unit);
      finish();
    }
  for (std::size_t b = 0; b < bodies; ++b) add_body(b, false);
  matrix_ = std::move(m);
  matrix_generation_ = generation();
  return matrix_;
}

template class RigidResistance<2>;
template class RigidResistance<3>;

}  // namespace odpd
