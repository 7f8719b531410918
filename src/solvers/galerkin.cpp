#include "odpd/solvers/galerkin.h"

#include <algorithm>
#include <cmath>

#include "multilevel_kernels.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"

namespace odpd {

namespace {

// Of a body beside the fluid, per radius in units of the grid's spacing. A body smaller than a cell strains little on the grid
// anyway, and more would only be in the way of the fluid around; one of several cells should be as stiff as the smoother
// bears. From 1.5 to 2.5 iterations change by one at most.
constexpr double stiffness_per_radius = 2.0;
constexpr std::int64_t fewest_free = 64;  // that stand for the fluid

template <int D>
using Triangle = std::array<float, index(GridShape<D>::triangle)>;

template <int D>
Triangle<D> triangle_of(const typename Resistance<D>::Block& block) {
  Triangle<D> w;
  std::size_t k = 0;
  for (std::size_t row = 0; row < D; ++row)
    for (std::size_t col = row; col < D; ++col) w[k++] = static_cast<float>(block[row * D + col]);
  return w;
}

/// One matrix per cell over its corners, added up to the stencil in the end.
template <int D>
class Elements {
 public:
  Elements(const GridShape<D>& shape, const Resistance<D>& resistance,
           const RigidResistance<D>* rigid, double moment, const SpinResistance<D>* spins)
      : shape_(shape),
        resistance_(resistance),
        rigid_(rigid),
        spins_(resistance.transverse() ? spins : nullptr) {
    if (rigid != nullptr) stiffen(moment / (2.0 * D * (D + 2)));
    std::int64_t cells = 1;
    for (int c = 0; c < 4; ++c) {
      const auto i = index(c);
      view_.cells[i] = c < D ? static_cast<float>(shape.cells[i]) : 1.0F;
      view_.wrap[i] = c < D && shape.periodic[i] ? view_.cells[i] : 0.0F;
      view_.stride[i] = c < D ? static_cast<std::int32_t>(cells) : 0;
      if (c < D) cells *= shape.cells[i];
    }
    sums_.resize(cells * size);
    sums_.fill(0.0F);
    view_.elements = sums_.data();
    place_nodes();
    if (!resistance.g().empty()) edges_.g = resistance.g().front().x.data();
    if (resistance.transverse()) edges_.across = &resistance.across().front().zeta_perp;
    if (spins_ != nullptr) leave_along();
  }
  void add_node(std::int64_t n);
  /// What all ranks added.
  void add_ranks(const Communicator& ranks) {
    ranks.sum(std::span(sums_.data(), index(sums_.size())));
  }
  void add_to(GridOperator<D>& a) const;

 private:
  static constexpr int corners = GridShape<D>::corners;
  static constexpr int triangle = GridShape<D>::triangle;
  static constexpr int size = element_floats<D>;

  /// inside_ of a constituent with this tau, in units of the grid, which shear tilts.
  void stiffen(double tau) {
    const RigidMap<D>& map = rigid_->map();
    for (std::size_t b = 0; b < index(map.bodies()); ++b) {
      double radius = 0.0;  // in units of the grid
      for (auto s = index(map.begin(b)); s < index(map.end(b)); ++s) {
        Vec<D> arm = map.arms()[s];
        for (std::size_t c = 0; c < D; ++c) arm.x[c] *= shape_.per_length.x[c];
        radius = std::max(radius, norm(arm));
      }
      stiffness_.push_back(static_cast<float>(stiffness_per_radius * radius));
    }
    inside_ = isotropic(tau, tau);
  }
  using Moments = std::array<float, index(triangle* triangle)>;
  /// The moments of  squares |grad v|^2 + crosses (d_a v_b d_b v_a + (div v)^2)  as kernels want them.
  Moments isotropic(double squares, double crosses) const {
    const std::array<Vec<D>, D> axis = grid_slopes(resistance_.box(), shape_);
    Moments moments;
    float* out = moments.data();
    for (std::size_t a = 0; a < D; ++a)
      for (std::size_t b = a; b < D; ++b)
        for (std::size_t c = 0; c < D; ++c)
          for (std::size_t d = c; d < D; ++d) {
            double square = 0.0;
            const double cross = axis[c].x[a] * axis[d].x[b] + axis[d].x[a] * axis[c].x[b];
            for (std::size_t k = 0; c == d && k < D; ++k) square += axis[k].x[a] * axis[k].x[b];
            *out++ = static_cast<float>(squares * square + crosses * cross);
          }
    return moments;
  }
  /// Leaves of edges with levers the friction along them.
  void leave_along() {
    g_.assign(resistance_.g().begin(), resistance_.g().end());
    across_.assign(resistance_.across().begin(), resistance_.across().end());
    edges_ = {g_.front().x.data(), &across_.front().zeta_perp};
    parallel_for(resistance_.nodes(), [&](std::int64_t n) {
      for (const auto& link : resistance_.links(index(n))) {
        if (link.node < n || !resistance_.sees_spins(link)) continue;
        Vec<D>& g = g_[index(link.edge)];
        auto& across = across_[index(link.edge)];
        const double along = across.sign * dot(g, g) + across.zeta_perp;
        const Vec<D> d = resistance_.box().separation(resistance_.position(index(n)),
                                                      resistance_.position(index(link.node)));
        g = std::sqrt(std::max(along, 0.0) / dot(d, d)) * d;
        across = {};
      }
    });
    constexpr double shares = D * (D + 2);
    turning_ = isotropic(0.5 * D / shares, (0.25 * D - 0.5) / shares);
  }
  /// The node's half of zeta_perp r^2 of edges with levers.
  double turned(std::size_t node) const {
    double sum = 0.0;
    for (const auto& link : resistance_.links(node)) {
      if (!resistance_.sees_spins(link)) continue;
      const Vec<D> d = resistance_.box().separation(resistance_.position(node),
                                                    resistance_.position(index(link.node)));
      sum += 0.5 * resistance_.across(link).zeta_perp * dot(d, d);
    }
    return sum;
  }
  void place_nodes() {
    positions_.resize(4 * resistance_.nodes());
    parallel_for(resistance_.nodes(), [&](std::int64_t n) {
      const Vec<D> r = grid_position(resistance_, index(n)) - shape_.low;
      for (int c = 0; c < 4; ++c)
        positions_.data()[4 * n + c] =
            c < D ? static_cast<float>(r[c < D ? c : 0] * shape_.per_length[c < D ? c : 0]) : 0.0F;
    });
    view_.position = positions_.data();
  }

  const GridShape<D>& shape_;
  const Resistance<D>& resistance_;
  const RigidResistance<D>* rigid_;
  const SpinResistance<D>* spins_;  // null where no friction sees a spin
  std::vector<float> stiffness_;    // per body
  Moments inside_{};                // of a constituent
  Moments turning_{};               // of zeta_perp r^2 of edges with levers
  std::vector<Vec<D>> g_;  // of all edges, where some have levers: the friction left to them
  std::vector<typename Resistance<D>::Across> across_;
  ElementView view_{};
  EdgeView edges_{};
  FloatArray positions_, sums_;
};

/// The node's half of its edges, and what holds it.
template <int D>
void Elements<D>::add_node(std::int64_t n) {
  static_assert(sizeof(Vec<D>) == D * sizeof(double));  // EdgeView reads them as numbers
  static_assert(sizeof(typename Resistance<D>::Link) == 2 * sizeof(std::int32_t));
  static_assert(sizeof(typename Resistance<D>::Across) == 2 * sizeof(double));
  const auto node = index(n);
  const auto links = resistance_.links(node);
  Triangle<D> anchor{};
  if (!resistance_.anchors().empty()) anchor = triangle_of<D>(resistance_.anchors()[node]);
  const bool of_body = rigid_ != nullptr && rigid_->is_constituent(node);
  const float* inside = of_body ? inside_.data() : nullptr;
  float stiffness = of_body ? stiffness_[rigid_->body_of(node)] : 0.0F;
  Moments both;
  if (spins_ != nullptr) {
    const auto more = static_cast<float>(turned(node));
    for (std::size_t k = 0; k < both.size(); ++k)
      both[k] = stiffness * inside_[k] + more * turning_[k];
    inside = both.data();
    stiffness = 1.0F;
  }
  multilevel_kernels().add_node[D - 2](
      view_, edges_, n, reinterpret_cast<const std::int32_t*>(links.data()), std::ssize(links),
      resistance_.anchors().empty() ? nullptr : anchor.data(), inside, stiffness);
}

template <int D>
void Elements<D>::add_to(GridOperator<D>& a) const {
  std::int64_t cell = 0;
  // The cells in the order of their numbers: a periodic grid of as many points.
  typename GridShape<D>::Index low{};
  for (; cell * size < sums_.size(); ++cell) {
    const float* const sum = sums_.data() + cell * size;
    for (int n = 0; n < corners; ++n) {
      auto point = low;
      for (int c = 0; c < D; ++c) {
        const auto i = index(c);
        point[i] += (n >> c) % 2;
        if (shape_.periodic[i]) point[i] %= shape_.points(c);
      }
      const std::int64_t number = shape_.number_of(point);
      for (int m = 0; m < corners; ++m) {
        int entry = 0, unit = 1;
        for (int c = 0; c < D; ++c, unit *= 3) entry += unit * ((m >> c) % 2 - (n >> c) % 2 + 1);
        float* const block = a.block(number, entry);
        for (int k = 0; k < triangle; ++k) block[16 * k] += sum[element_place<D>(k, n, m)];
      }
    }
    for (std::size_t c = 0; c < D; ++c) {
      if (++low[c] < shape_.cells[c]) break;
      low[c] = 0;
    }
  }
}

}  // namespace

template <int D>
Vec<D> grid_position(const Resistance<D>& resistance, std::size_t node) {
  return resistance.box().straightened(resistance.position(node));
}

template <int D>
GridPosition<D> locate(const GridShape<D>& shape, const double* position) {
  GridPosition<D> at;
  for (std::size_t c = 0; c < D; ++c) {
    const std::int64_t cells = shape.cells[c];
    const double x = (position[c] - shape.low.x[c]) * shape.per_length.x[c];
    std::int64_t cell = static_cast<std::int64_t>(x) - (x < 0.0 ? 1 : 0);
    const auto in_cell = static_cast<float>(x - static_cast<double>(cell));
    if (shape.periodic[c]) {
      if (cell < 0) cell += cells;
      if (cell >= cells) cell -= cells;
    }
    // A particle outside a bounded direction (or not quite inside a periodic one) belongs to the border cell.
    at.cell[c] = std::clamp<std::int64_t>(cell, 0, cells - 1);
    at.in_cell[c] = cell < at.cell[c] ? 0.0F : cell > at.cell[c] ? 1.0F : std::min(in_cell, 1.0F);
  }
  return at;
}

template <int D>
std::array<Vec<D>, D> grid_slopes(const Box<D>& box, const GridShape<D>& shape) {
  std::array<Vec<D>, D> axis{};
  for (std::size_t c = 0; c < D; ++c) axis[c].x[c] = 1.0;
  if (box.shear)
    axis[index(box.shear->gradient)][box.shear->flow] = -box.offset / box.size[box.shear->gradient];
  for (Vec<D>& unit : axis)
    for (std::size_t a = 0; a < D; ++a) unit.x[a] *= shape.per_length.x[a];
  return axis;
}

template <int D>
FrictionSpread friction_spread(const Resistance<D>& resistance, const RigidResistance<D>* rigid) {
  const Share share = resistance.share();
  std::array<double, 5> sums{};
  auto& [moment, total, ties, tied, logarithms] = sums;
  // Constituents have no links inside their body; where there are few others they must do.
  const std::int64_t free =
      resistance.nodes() - (rigid == nullptr ? 0 : rigid->map().constituents());
  const bool of_free = rigid != nullptr && free >= fewest_free;
  const std::int64_t looked_at = of_free ? free : resistance.nodes();
  // Some hundred particles tell it well enough.
  const std::int64_t step = std::max<std::int64_t>(1, looked_at / 256);
  std::int64_t until_next = 0;
  for (std::int64_t n = 0; n < resistance.nodes(); ++n) {
    if ((of_free && rigid->is_constituent(index(n))) || until_next-- > 0) continue;
    until_next = step - 1;
    if (!share.owns(n)) continue;
    const auto node = index(n);
    const Vec<D> own = resistance.position(node);
    double sum = 0.0, squares = 0.0, own_moment = 0.0;
    for (const auto& link : resistance.links(node)) {
      const auto other = index(link.node);
      const Vec<D> d = resistance.box().separation(own, resistance.position(other));
      double zeta = dot(resistance.g(link), resistance.g(link));
      if (resistance.transverse())
        zeta = resistance.across(link).sign * zeta + D * resistance.across(link).zeta_perp;
      sum += zeta;
      squares += zeta * zeta;
      moment += zeta * dot(d, d);
      own_moment += zeta * dot(d, d);
    }
    total += sum;
    if (!(squares > 0.0)) continue;
    ties += sum * sum / squares;
    logarithms += std::log(own_moment);
    tied += 1.0;
  }
  share.ranks->sum(std::span(sums));
  if (!(total > 0.0)) return {};
  return {std::sqrt(moment / total), ties / tied, std::exp(logarithms / tied)};
}

template <int D>
GridOperator<D> galerkin(const Resistance<D>& resistance, const GridShape<D>& shape,
                         const RigidResistance<D>* rigid, double moment,
                         const SpinResistance<D>* spins) {
  Elements<D> elements(shape, resistance, rigid, moment, spins);
  const Share share = resistance.share();
  for (std::int64_t n = share.first; n < share.end(resistance.nodes()); ++n) elements.add_node(n);
  elements.add_ranks(*share.ranks);
  GridOperator<D> a(shape);
  elements.add_to(a);
  return a;
}

template Vec<2> grid_position<2>(const Resistance<2>&, std::size_t);
template Vec<3> grid_position<3>(const Resistance<3>&, std::size_t);
template GridPosition<2> locate<2>(const GridShape<2>&, const double*);
template GridPosition<3> locate<3>(const GridShape<3>&, const double*);
template std::array<Vec<2>, 2> grid_slopes<2>(const Box<2>&, const GridShape<2>&);
template std::array<Vec<3>, 3> grid_slopes<3>(const Box<3>&, const GridShape<3>&);
template FrictionSpread friction_spread<2>(const Resistance<2>&, const RigidResistance<2>*);
template FrictionSpread friction_spread<3>(const Resistance<3>&, const RigidResistance<3>*);
template GridOperator<2> galerkin<2>(const Resistance<2>&, const GridShape<2>&,
                                     const RigidResistance<2>*, double, const SpinResistance<2>*);
template GridOperator<3> galerkin<3>(const Resistance<3>&, const GridShape<3>&,
                                     const RigidResistance<3>*, double, const SpinResistance<3>*);

}  // namespace odpd
