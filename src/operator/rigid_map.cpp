#include "odpd/operator/rigid_map.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"

namespace odpd {

namespace {

template <int D>
using Square = Eigen::Matrix<double, D, D, Eigen::RowMajor>;

template <int D>
Vec<D> times(const std::array<double, index(D* D)>& m, const Vec<D>& v) {
  Vec<D> product{};
  for (std::size_t row = 0; row < D; ++row)
    for (std::size_t col = 0; col < D; ++col) product.x[row] += m[row * D + col] * v.x[col];
  return product;
}

template <int D>
Vec<D> from(const double* x) {
  Vec<D> v;
  for (std::size_t c = 0; c < D; ++c) v.x[c] = x[c];
  return v;
}

}  // namespace

template <int D>
void RigidMap<D>::rebuild(const DofMap<D>& dofs, std::span<const Vec<D>> arms) {
  const auto bodies = index(dofs.bodies());
  begin_.assign(1, 0);
  for (std::size_t b = 0; b < bodies; ++b)
    begin_.push_back(begin_.back() + std::ssize(dofs.constituents(b)));
  row_.resize(index(begin_.back()));
  arm_.resize(row_.size());
  scale_.resize(bodies);
  parallel_for(dofs.bodies(), [&](std::int64_t body) {
    const auto b = index(body);
    auto member = index(begin_[b]);
    for (const std::int32_t particle : dofs.constituents(b)) {
      row_[member] = dofs.mobile_of(index(particle));
      arm_[member++] = arms[index(particle)];
    }
    scale_[b] = scale_of(std::span(arm_).subspan(index(begin_[b]), dofs.constituents(b).size()));
  });
}

template <int D>
auto RigidMap<D>::scale_of(std::span<const Vec<D>> arms) -> Scale {
  const std::array<Vec<D>, D> inertia = moment_of_inertia<D>(arms);
  Square<D> moments;
  for (int row = 0; row < D; ++row)
    for (int col = 0; col < D; ++col) moments(row, col) = inertia[index(row)][col];
  const Eigen::SelfAdjointEigenSolver<Square<D>> axes(moments);
  const int unturned = D - rotations<D>(arms);  // eigenvalues ascend
  Square<D> turn = Square<D>::Zero(), unturn = turn, unused = turn;
  for (int k = 0; k < D; ++k) {
    const Square<D> onto = axes.eigenvectors().col(k) * axes.eigenvectors().col(k).transpose();
    if (k < unturned) {
      unused += onto;
      continue;
    }
    const double root = std::sqrt(axes.eigenvalues()(k));
    turn += onto / root;
    unturn += onto * root;
  }
  Scale scale;
  scale.inverse_root_mass = 1.0 / std::sqrt(static_cast<double>(arms.size()));
  Eigen::Map<Square<D>>(scale.turn.data()) = turn;
  Eigen::Map<Square<D>>(scale.unturn.data()) = unturn;
  Eigen::Map<Square<D>>(scale.unused.data()) = unused;
  return scale;
}

template <int D>
RigidMotion<D> RigidMap<D>::motion(std::size_t b, const double* y_linear,
                                   const double* y_angular) const {
  return {scale_[b].inverse_root_mass * from<D>(y_linear),
          times<D>(scale_[b].turn, from<D>(y_angular))};
}

template <int D>
void RigidMap<D>::unknowns(std::size_t b, const RigidMotion<D>& motion, double* y_linear,
                           double* y_angular) const {
  const Vec<D> angular = times<D>(scale_[b].unturn, motion.angular);
  for (std::size_t c = 0; c < D; ++c) {
    y_linear[c] = motion.velocity.x[c] / scale_[b].inverse_root_mass;
    y_angular[c] = angular.x[c];
  }
}

template <int D>
void RigidMap<D>::load(std::size_t b, const RigidLoad<D>& load, double* y_linear,
                       double* y_angular) const {
  const Vec<D> angular = times<D>(scale_[b].turn, load.torque);
  for (std::size_t c = 0; c < D; ++c) {
    y_linear[c] = scale_[b].inverse_root_mass * load.force.x[c];
    y_angular[c] = angular.x[c];
  }
}

template class RigidMap<2>;
template class RigidMap<3>;

}  // namespace odpd
