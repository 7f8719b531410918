// SpinResistance as a matrix.
#include <algorithm>

#include "odpd/operator/spin_resistance.h"
#include "small_blocks.h"

namespace odpd {

template <int D>
void SpinResistance<D>::velocity_parts(std::size_t row, Parts& parts) const {
  const auto front = static_cast<std::int32_t>(spins());
  if (!is_constituent(row)) {
    const auto node = with_bodies_ ? velocities_.node_of(row) : static_cast<std::int32_t>(row);
    parts.push_back({front + node, identity<D>(1.0)});
    return;
  }
  const std::size_t b = velocities_.body_of(row);
  parts.push_back({front + static_cast<std::int32_t>(velocities_.linear_node(b)),
                   identity<D>(velocities_.map().inverse_root_mass(b))});
  parts.push_back(
      {front + static_cast<std::int32_t>(b), velocities_.lever(b, index(member_of_[row]))});
}

template <int D>
void SpinResistance<D>::spin_parts(std::size_t row, Parts& parts) const {
  if (spin_of_[row] >= 0) {
    parts.push_back({spin_of_[row], identity<D>(1.0 / length_[index(spin_of_[row])])});
  } else if (is_constituent(row)) {
    const std::size_t b = velocities_.body_of(row);
    parts.push_back({static_cast<std::int32_t>(spins()) + static_cast<std::int32_t>(b),
                     velocities_.map().turn(b)});
  }
}

template <int D>
const BlockCsr& SpinResistance<D>::matrix() const {
  if (matrix_generation_ == generation()) return matrix_;
  std::vector<Parts> rows(index(nodes()));
  const auto front = static_cast<std::int32_t>(spins());
  const BlockCsr& inner = velocities_.system().matrix();
  for (std::size_t n = 0; n < index(inner.rows); ++n)
    for (auto k = index(inner.start[n]); k < index(inner.start[n + 1]); ++k) {
      Block block;
      std::copy_n(&inner.value[k * D * D], D * D, block.begin());
      rows[index(front) + n].push_back({front + inner.column[k], block});
    }
  const auto add = [&](const Parts& left, const Parts& right, const Block& block) {
    for (const auto& [row, of_row] : left)
      for (const auto& [column, of_column] : right) {
        rows[index(row)].push_back({column, {}});
        add_triple_product<D>(of_row.data(), block.data(), of_column.data(),
                              rows[index(row)].back().second.data());
      }
  };
  Parts v, w, v_other, w_other;
  for (std::size_t row = 0; row < spin_of_.size(); ++row) {
    v.clear();
    w.clear();
    velocity_parts(row, v);
    spin_parts(row, w);
    for (const Link& link : links(row)) {
      v_other.clear();
      w_other.clear();
      if (link.other >= 0) {
        velocity_parts(index(link.other), v_other);
        spin_parts(index(link.other), w_other);
      }
      const Block turn = cross_matrix<D>(link.e);
      const auto scaled = [](Block m, double factor) {
        for (double& value : m) value *= factor;
        return m;
      };
      const Block square = product_of<D>(turn, turn, true);
      const Block transposed = product_of<D>(turn, identity<D>(1.0), true);
      const double own = link.zeta_perp * link.own, theirs = link.zeta_perp * link.theirs;
      add(v, w, scaled(turn, own));
      add(v, w_other, scaled(turn, theirs));
      add(w, v, scaled(transposed, own));
      add(w, v_other, scaled(transposed, -own));
      add(w, w, scaled(square, own * link.own));
      add(w, w_other, scaled(square, own * link.theirs));
    }
  }
  for (std::size_t s = 0; s < length_.size(); ++s) {
    Block own{};
    for (std::size_t c = 0; c < D; ++c)
      own[c * D + c] = c < index(rotation_components<D>) ? spin_shift_[s] : 1.0;
    rows[s].push_back({static_cast<std::int32_t>(s), own});
  }
  BlockCsr m;
  m.block = D;
  m.rows = static_cast<std::int32_t>(nodes());
  m.start.push_back(0);
  for (Parts& row : rows) {
    std::stable_sort(row.begin(), row.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (std::size_t k = 0; k < row.size(); ++k) {
      if (k == 0 || row[k].first != row[k - 1].first) {
        m.column.push_back(row[k].first);
        m.value.insert(m.value.end(), row[k].second.begin(), row[k].second.end());
      } else {
        for (std::size_t c = 0; c < D * D; ++c)
          m.value[m.value.size() - D * D + c] += row[k].second[c];
      }
    }
    m.start.push_back(static_cast<std::int32_t>(m.column.size()));
    row = {};
  }
  matrix_ = std::move(m);
  matrix_generation_ = generation();
  return matrix_;
}

#define ODPD_INSTANTIATE(D)                                                   \
  template void SpinResistance<D>::velocity_parts(std::size_t, Parts&) const; \
  template void SpinResistance<D>::spin_parts(std::size_t, Parts&) const;     \
  template const BlockCsr& SpinResistance<D>::matrix() const;
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
