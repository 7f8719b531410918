#include "odpd/operator/rigid_resistance.h"

#include <algorithm>
#include <map>

#include "odpd/core/index.h"

namespace odpd {

namespace {

// target += left^T middle right, D x D row-major.
template <int D>
void add_triple_product(const double* left, const double* middle, const double* right,
                        double* target) {
  for (std::size_t row = 0; row < D; ++row)
    for (std::size_t k = 0; k < D; ++k)
      for (std::size_t l = 0; l < D; ++l) {
        const double factor = left[k * D + row] * middle[k * D + l];
        for (std::size_t col = 0; col < D; ++col)
          target[row * D + col] += factor * right[l * D + col];
      }
}

}  // namespace

template <int D>
void RigidResistance<D>::rebuild(const PairNetwork<D>& network, const DofMap<D>& dofs,
                                 const Particles<D>& particles, std::span<const Vec<D>> positions,
                                 std::span<const Vec<D>> arms, double shift, double stiffness_time,
                                 double bond_time) {
  mobile_.rebuild(network, dofs, particles, positions, shift, stiffness_time, bond_time, arms);
  dofs_ = dofs.bodies() > 0 ? &dofs : nullptr;
  if (dofs_ == nullptr) return;
  arms_.assign(arms.begin(), arms.end());
  node_.resize(index(dofs.mobile()));
  auto node = static_cast<std::int32_t>(dofs.free_node(0));
  for (std::size_t s = 0; s < node_.size(); ++s) {
    const auto p = index(dofs.particle_of(s));
    node_[s] = particles.is_free(p) ? node++ : -particles.body_of(p) - 1;
  }
}

template <int D>
void RigidResistance<D>::apply(std::span<const double> x, std::span<double> y) const {
  const auto n = index(dofs_->mobile());
  // Through vectors per particle: few of a scene's particles are known.
  std::vector<Vec<D>> velocity, force(arms_.size());
  dofs_->scatter(arms_, x, force, velocity);
  std::vector<double> v(n * D), f(n * D);
  for (std::size_t s = 0; s < n; ++s)
    for (std::size_t c = 0; c < D; ++c) v[s * D + c] = velocity[index(dofs_->particle_of(s))].x[c];
  mobile_.apply(v, f);
  for (std::size_t s = 0; s < n; ++s)
    for (std::size_t c = 0; c < D; ++c) force[index(dofs_->particle_of(s))].x[c] = f[s * D + c];
  std::vector<double> q;
  dofs_->gather(arms_, force, q);
  std::copy(q.begin(), q.end(), y.begin());
  for (std::size_t w = 0; w < index(dofs_->bodies()); ++w)
    for (std::size_t c = rotation_components<D>; c < D; ++c) y[w * D + c] = x[w * D + c];
}

template <int D>
auto RigidResistance<D>::movers(std::size_t row) const -> std::vector<Mover> {
  typename Resistance<D>::Block unit{}, turn{};
  for (std::size_t c = 0; c < D; ++c) unit[c * D + c] = 1.0;
  if (node_[row] >= 0) return {{index(node_[row]), unit}};
  const auto body = index(-node_[row] - 1);
  const Vec<D>& arm = arms_[index(dofs_->particle_of(row))];
  for (std::size_t c = 0; c < D; ++c) {
    Vec<D> w{};
    w.x[c] = 1.0;
    const Vec<D> v = swing(w, arm);
    for (std::size_t k = 0; k < D; ++k) turn[k * D + c] = v.x[k];
  }
  return {{dofs_->body_node(body), unit}, {body, turn}};
}

template <int D>
void RigidResistance<D>::add_unused(std::size_t node, double* block) const {
  if (node >= index(dofs_->bodies())) return;
  for (std::size_t c = rotation_components<D>; c < D; ++c) block[c * D + c] += 1.0;
}

template <int D>
void RigidResistance<D>::block_diagonal(std::span<double> blocks) const {
  std::fill(blocks.begin(), blocks.end(), 0.0);
  const Share own_mobile = mobile_.share();
  // No edges inside a body: its constituents' diagonal blocks are all that falls on its own.
  for (std::size_t s = 0; s < node_.size(); ++s) {
    if (node_[s] < 0 && !own_mobile.owns(s)) continue;
    for (const Mover& m : movers(s))
      add_triple_product<D>(m.map.data(), mobile_.diagonal()[s].data(), m.map.data(),
                            &blocks[m.node * D * D]);
  }
  const std::size_t of_bodies = index(dofs_->bodies()) * D * D;
  own_mobile.ranks->sum(blocks.first(of_bodies));
  own_mobile.ranks->sum(blocks.last(of_bodies));
  for (std::size_t n = 0; n < index(nodes()); ++n) add_unused(n, &blocks[n * D * D]);
}

template <int D>
const BlockCsr& RigidResistance<D>::matrix() const {
  if (matrix_generation_ == generation()) return matrix_;
  const BlockCsr& inner = mobile_.matrix();
  const auto n = index(nodes());
  std::vector<std::map<std::int32_t, typename Resistance<D>::Block>> rows(n);
  for (std::size_t s = 0; s < node_.size(); ++s)
    for (auto k = index(inner.start[s]); k < index(inner.start[s + 1]); ++k)
      for (const Mover& left : movers(s))
        for (const Mover& right : movers(index(inner.column[k])))
          add_triple_product<D>(left.map.data(), &inner.value[k * D * D], right.map.data(),
                                rows[left.node][static_cast<std::int32_t>(right.node)].data());
  BlockCsr m;
  m.block = D;
  m.rows = static_cast<std::int32_t>(n);
  m.start.push_back(0);
  for (std::size_t row = 0; row < n; ++row) {
    add_unused(row, rows[row][static_cast<std::int32_t>(row)].data());
    for (const auto& [column, block] : rows[row]) {
      m.column.push_back(column);
      m.value.insert(m.value.end(), block.begin(), block.end());
    }
    m.start.push_back(static_cast<std::int32_t>(m.column.size()));
  }
  matrix_ = std::move(m);
  matrix_generation_ = generation();
  return matrix_;
}

template class RigidResistance<2>;
template class RigidResistance<3>;

}  // namespace odpd
