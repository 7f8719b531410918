#include "odpd/operator/free_motions.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>

#include "odpd/core/index.h"
#include "odpd/core/rotation.h"
#include "odpd/operator/resistance.h"

namespace odpd {

namespace {

constexpr std::size_t walks = 16;  // around the box, before all links are looked at
// Square root of u^T R u beside that of R, for |u| = 1: rounding gives some 1e-15, and R u of what is left out is below this
// part of R.
constexpr double no_dissipation = 1e-9;
constexpr double parallel = 1e-3;  // sine of the angle of two directions

/// From a particle (a row of R) to the other end of its link.
template <int D>
Vec<D> way(const Resistance<D>& resistance, std::size_t row,
           const typename Resistance<D>::Link& l) {
  return resistance.box().separation(resistance.position(index(l.node)), resistance.position(row));
}

inline bool independent(const Vec<2>& a, const Vec<2>& b) {
  return std::abs(a[0] * b[1] - a[1] * b[0]) > parallel * norm(a) * norm(b);
}
inline bool independent(const Vec<3>& a, const Vec<3>& b) {
  return norm(swing(a, b)) > parallel * norm(a) * norm(b);
}

/// Directions in the order of coming: enough of them, D - 1 independent ones, leave no axis to turn about.
template <int D>
class Directions {
 public:
  void add(const Vec<D>& d) {
    if (count_ == 0) first_ = d;
    if (count_ == 0 || (count_ == 1 && independent(first_, d))) ++count_;
  }
  bool enough() const { return count_ >= D - 1; }

 private:
  Vec<D> first_{};
  int count_ = 0;
};

// ---- Groups that hold fast, told from a few links

/// Which body a mobile particle belongs to; -1: none.
template <int D>
class Membership {
 public:
  explicit Membership(const DofMap<D>& dofs) {
    if (dofs.bodies() == 0) return;
    body_.assign(index(dofs.mobile()), -1);
    for (std::size_t b = 0; b < index(dofs.bodies()); ++b)
      for (const std::int32_t p : dofs.constituents(b))
        body_[index(dofs.mobile_of(index(p)))] = static_cast<std::int32_t>(b);
  }
  std::int32_t operator[](std::size_t row) const { return body_.empty() ? -1 : body_[row]; }

 private:
  std::vector<std::int32_t> body_;
};

/// A path along links and through bodies from `start`, ever further along c and back to an image of `start`: how far it went
/// round the box.
template <int D>
std::optional<Vec<D>> winding(const Resistance<D>& resistance, const DofMap<D>& dofs,
                              std::span<const Vec<D>> arms, const Membership<D>& body,
                              std::size_t start, int c) {
  const double length = resistance.box().size[c];
  Vec<D> gone{};
  std::size_t row = start;
  for (std::int64_t step = 0; step < resistance.nodes() && gone[c] < 2.0 * length; ++step) {
    std::int32_t next = -1;
    Vec<D> reached{};
    double best = 0.0;
    // Whether the walk may end at `node`, a step d away; else what speaks for going there.
    const auto ends_at = [&](std::int32_t node, const Vec<D>& d) {
      const Vec<D> there = gone + d;
      if (index(node) == start && there[c] > 0.25 * length) {
        reached = there;
        return true;
      }
      Vec<D> aside = there;
      aside[c] = 0.0;
      const double merit = d[c] - norm(aside);
      if (!(d[c] > 0.0) || (next >= 0 && merit <= best)) return false;
      next = node;
      reached = there;
      best = merit;
      return false;
    };
    for (const auto& link : resistance.links(row))
      if (resistance.ties(link) && ends_at(link.node, way(resistance, row, link))) return reached;
    if (body[row] >= 0) {
      const Vec<D>& arm = arms[index(dofs.particle_of(row))];
      for (const std::int32_t p : dofs.constituents(index(body[row])))
        if (ends_at(dofs.mobile_of(index(p)), arms[index(p)] - arm)) return reached;
    }
    if (next < 0) return {};
    row = index(next);
    gone = reached;
  }
  return {};
}

/// Links that go round the box one way leave rotations about that way, two ways none; in two dimensions one is enough.
template <int D>
bool goes_round(const Resistance<D>& resistance, const DofMap<D>& dofs,
                std::span<const Vec<D>> arms) {
  const Membership<D> body(dofs);
  Directions<D> ways;
  for (int c = 0; c < D && !ways.enough(); ++c) {
    if (!resistance.box().is_periodic(c)) continue;
    std::optional<Vec<D>> found;
    for (std::size_t k = 0; k < walks && !found; ++k) {
      const std::size_t start = k * index(resistance.nodes()) / walks;
      found = winding(resistance, dofs, arms, body, start, c);
    }
    if (found) ways.add(*found);
  }
  return ways.enough();
}

/// Friction with known velocities holds the particle in every direction.
template <int D>
bool stuck(const Resistance<D>& resistance, std::size_t row) {
  return relative_determinant<D>(resistance.anchors()[row].data()) > 1e-6;
}

/// No slip of this link is without friction, beside all friction of the particle.
template <int D>
bool resists_all_slip(const Resistance<D>& resistance, std::size_t row,
                      const typename Resistance<D>::Link& link) {
  if (!resistance.transverse()) return false;
  double of_particle = 0.0;
  for (std::size_t c = 0; c < D; ++c) of_particle += resistance.diagonal()[row][c * D + c];
  if (resistance.sees_spins(link)) return false;
  const auto& across = resistance.across(link);
  const Vec<D>& g = resistance.g(link);
  const double along = across.sign * dot(g, g) + across.zeta_perp;
  return std::min(along, across.zeta_perp) > 1e-6 * of_particle;
}

/// D - 1 linked neighbours, not on a line with the particle, have its velocity: so their group does not turn. Neighbours do
/// where links resist all slip, or where they and the particle are stuck; with known velocities it must be stuck.
template <int D>
bool holds_fast(const Resistance<D>& resistance, std::size_t row) {
  const bool anchored = !resistance.anchors().empty();
  if (anchored && !stuck(resistance, row)) return false;
  Directions<D> ways;
  for (const auto& link : resistance.links(row)) {
    if (!resistance.ties(link)) continue;
    if (!(anchored && stuck(resistance, index(link.node))) &&
        !resists_all_slip(resistance, row, link))
      continue;
    const Vec<D> d = way(resistance, row, link);
    if (norm(d) > 0.0) ways.add(d);
    if (ways.enough()) return true;
  }
  return false;
}

// ---- The others, from all of their links

/// Rows of a tall matrix S, kept as a triangle T with T^T T = S^T S: no square is formed, so that what is zero to rounding is
/// told from what is small.
template <int columns>
class Slips {
 public:
  using Row = Eigen::Matrix<double, 1, columns>;
  Slips() { rows_.setZero(); }
  void add(const Row& row) {
    if (used_ == rows_.rows()) compress();
    rows_.row(used_++) = row;
  }
  Eigen::Matrix<double, columns, columns> triangle() {
    compress();
    return rows_.template topRows<columns>();
  }

 private:
  using Rows = Eigen::Matrix<double, 64 + columns, columns>;
  void compress() {
    const Eigen::HouseholderQR<Rows> parts(rows_);
    rows_.setZero();
    rows_.template topRows<columns>().template triangularView<Eigen::Upper>() =
        parts.matrixQR().template topRows<columns>();
    used_ = columns;
  }

  Rows rows_;
  Eigen::Index used_ = 0;
};

template <int D>
class GroupMotions {
 public:
  GroupMotions(const Resistance<D>& resistance, const DofMap<D>& dofs, std::span<const Vec<D>> arms)
      : resistance_(resistance),
        dofs_(dofs),
        arms_(arms),
        body_(dofs),
        at_(index(dofs.mobile())),
        seen_(index(dofs.mobile()), 0),
        body_seen_(index(dofs.bodies()), 0) {}

  void add_to(FreeMotions& found, std::size_t root) {
    unfold(root);
    const bool anchored = !resistance_.anchors().empty();
    const int first = anchored ? 0 : D;
    const Eigen::MatrixXd free = without_dissipation(first);
    if (free.cols() == 0) return;
    found.groups.push_back({static_cast<std::int64_t>(rows_.size()), dofs_.particle_of(root),
                            static_cast<std::int64_t>(free.cols())});
    found.motions += free.cols();
    if (found.motions > most_free_motions) return found.basis.clear();
    for (Eigen::Index k = 0; k < free.cols(); ++k) {
      std::vector<double> u(at_.size() * D, 0.0);
      for (Eigen::Index c = 0; c < free.rows(); ++c)
        for (const std::size_t row : rows_) {
          const Vec<D> v = free(c, k) * velocity(first + static_cast<int>(c), at_[row]);
          for (std::size_t a = 0; a < D; ++a) u[row * D + a] += v.x[a];
        }
      found.basis.push_back(std::move(u));
    }
  }

 private:
  static constexpr int motions = D + rotation_components<D>;

  /// Positions of the group's particles along its links, and their centre.
  void unfold(std::size_t root) {
    rows_.assign(1, root);
    at_[root] = resistance_.position(root);
    seen_[root] = 1;
    const auto reach = [&](std::size_t row, const Vec<D>& there) {
      if (seen_[row] != 0) return;
      seen_[row] = 1;
      at_[row] = there;
      rows_.push_back(row);
    };
    for (std::size_t k = 0; k < rows_.size(); ++k) {
      const std::size_t row = rows_[k];
      for (const auto& link : resistance_.links(row))
        if (seen_[index(link.node)] == 0 && resistance_.ties(link))
          reach(index(link.node), at_[row] + way(resistance_, row, link));
      if (body_[row] < 0) continue;
      const auto body = index(body_[row]);
      if (body_seen_[body] != 0) continue;
      body_seen_[body] = 1;
      const Vec<D> centre = at_[row] - arms_[index(dofs_.particle_of(row))];
      for (const std::int32_t p : dofs_.constituents(body))
        reach(index(dofs_.mobile_of(index(p))), centre + arms_[index(p)]);
    }
    Vec<D> sum{};
    for (const std::size_t row : rows_) sum += at_[row];
    centre_ = (1.0 / static_cast<double>(rows_.size())) * sum;
  }

  /// Motion c of a point at r: translations, then rotations about the centre.
  Vec<D> velocity(int c, const Vec<D>& r) const {
    Vec<D> unit{};
    unit[c < D ? c : c - D] = 1.0;
    return c < D ? unit : swing(unit, r - centre_);
  }

  /// Of a force at an arm: its power in each of the motions.
  static typename Slips<motions>::Row power(const Vec<D>& force, const Vec<D>& arm,
                                            bool translates) {
    typename Slips<motions>::Row row;
    const Vec<D> turns = torque(arm, force);
    for (int c = 0; c < D; ++c) row(c) = translates ? force[c] : 0.0;
    for (int c = D; c < motions; ++c) row(c) = turns[c - D];
    return row;
  }

  /// Adds slips times the roots of their friction: of links to later particles, and of known neighbours.
  void add_slips(std::size_t row, Slips<motions>& slips) const {
    for (const auto& link : resistance_.links(row)) {
      if (!resistance_.ties(link) || index(link.node) < row) continue;
      const Vec<D> apart = at_[row] - at_[index(link.node)];
      const Vec<D>& g = resistance_.g(link);
      if (!resistance_.transverse()) {
        slips.add(power(g, apart, false));
        continue;
      }
      typename Resistance<D>::Block friction{};
      const auto& across = resistance_.across(link);
      if (resistance_.sees_spins(link)) {
        const double along = across.sign * dot(g, g) + across.zeta_perp;
        slips.add(power(std::sqrt(along) / norm(apart) * apart, apart, false));
        continue;
      }
      for (std::size_t a = 0; a < D; ++a)
        for (std::size_t b = 0; b < D; ++b)
          friction[a * D + b] = across.sign * g.x[a] * g.x[b] + (a == b ? across.zeta_perp : 0.0);
      for (const Vec<D>& root : roots(friction)) slips.add(power(root, apart, false));
    }
    if (resistance_.anchors().empty()) return;
    for (const Vec<D>& root : roots(resistance_.anchors()[row]))
      slips.add(power(root, at_[row] - centre_, true));
  }
  /// Vectors with block = sum of their squares; what rounding adds to a singular block left out.
  static std::vector<Vec<D>> roots(const typename Resistance<D>::Block& block) {
    const Eigen::Map<const Eigen::Matrix<double, D, D, Eigen::RowMajor>> matrix(block.data());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, D, D>> parts(matrix);
    std::vector<Vec<D>> found;
    for (int k = 0; k < D; ++k) {
      const double size = parts.eigenvalues()(k);
      if (!(size > 1e-12 * parts.eigenvalues()(D - 1))) continue;
      Vec<D> root;
      for (int c = 0; c < D; ++c) root[c] = std::sqrt(size) * parts.eigenvectors()(c, k);
      found.push_back(root);
    }
    return found;
  }

  /// Combinations of the motions from `first` on, orthonormal over the particles, that cost nothing: columns.
  Eigen::MatrixXd without_dissipation(int first) const {
    const int count = motions - first;
    const Eigen::MatrixXd unit = orthonormal(first);
    double stiffest = 0.0;
    for (const std::size_t row : rows_)
      for (std::size_t c = 0; c < D; ++c)
        stiffest = std::max(stiffest, resistance_.diagonal()[row][c * D + c]);
    Slips<motions> slips;
    Eigen::MatrixXd left = unit;
    for (std::size_t k = 0; k < rows_.size() && left.cols() > 0; ++k) {
      add_slips(rows_[k], slips);
      // More links only cost more. Seldom, as it is dearer than many links.
      if (k + 1 < rows_.size() && !std::has_single_bit(k + 1)) continue;
      const Eigen::JacobiSVD<Eigen::MatrixXd> costs(slips.triangle().rightCols(count) * unit,
                                                    Eigen::ComputeFullV);
      Eigen::Index costly = 0;  // singular values descend
      while (costly < costs.singularValues().size() &&
             costs.singularValues()(costly) > no_dissipation * std::sqrt(stiffest))
        ++costly;
      left = unit * costs.matrixV().rightCols(unit.cols() - costly);
    }
    return left;
  }

  /// Combinations of the motions from `first` on, orthonormal over the particles; a line does not turn about itself.
  Eigen::MatrixXd orthonormal(int first) const {
    const int count = motions - first;
    Eigen::Matrix<double, motions, motions> products;
    products.setZero();
    for (const std::size_t row : rows_) {
      Eigen::Matrix<double, D, motions> of_row;
      for (int c = 0; c < motions; ++c) {
        const Vec<D> v = velocity(c, at_[row]);
        for (int k = 0; k < D; ++k) of_row(k, c) = v[k];
      }
      products.noalias() += of_row.transpose().lazyProduct(of_row);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> sizes(
        products.bottomRightCorner(count, count));
    const double largest = sizes.eigenvalues().maxCoeff();
    Eigen::MatrixXd unit(count, 0);
    for (int k = 0; k < count; ++k) {
      const double size = sizes.eigenvalues()(k);
      if (!(size > 1e-12 * largest)) continue;
      unit.conservativeResize(Eigen::NoChange, unit.cols() + 1);
      unit.rightCols(1) = sizes.eigenvectors().col(k) / std::sqrt(size);
    }
    return unit;
  }

  const Resistance<D>& resistance_;
  const DofMap<D>& dofs_;
  std::span<const Vec<D>> arms_;
  Membership<D> body_;
  std::vector<Vec<D>> at_;         // per mobile particle
  std::vector<char> seen_;         // per mobile particle
  std::vector<char> body_seen_;    // per body
  std::vector<std::size_t> rows_;  // of the group
  Vec<D> centre_{};
};

}  // namespace

template <int D>
FreeMotions free_motions(const Resistance<D>& resistance, const DofMap<D>& dofs,
                         std::span<const Vec<D>> arms, std::span<const std::int32_t> parent) {
  FreeMotions found;
  const bool anchored = !resistance.anchors().empty();
  if (parent.empty() || (!anchored && goes_round(resistance, dofs, arms))) return found;
  std::vector<char> open(parent.size(), 0);  // roots of groups that may have free motions
  std::size_t left = 0;
  for (std::size_t n = 0; n < parent.size(); ++n)
    if (index(parent[n]) == n) open[n] = 1, ++left;
  const auto root = [&](std::size_t n) {
    while (index(parent[n]) != n) n = index(parent[n]);
    return n;
  };
  const bool tell = anchored || resistance.transverse();
  for (std::size_t n = 0; tell && n < parent.size() && left > 0; ++n)
    if (char& group = open[root(n)]; group != 0 && holds_fast(resistance, n)) group = 0, --left;
  if (left == 0) return found;
  GroupMotions<D> group(resistance, dofs, arms);
  for (std::size_t n = 0; n < parent.size(); ++n)
    if (open[n] != 0) group.add_to(found, n);
  return found;
}

template FreeMotions free_motions<2>(const Resistance<2>&, const DofMap<2>&,
                                     std::span<const Vec<2>>, std::span<const std::int32_t>);
template FreeMotions free_motions<3>(const Resistance<3>&, const DofMap<3>&,
                                     std::span<const Vec<3>>, std::span<const std::int32_t>);

}  // namespace odpd
