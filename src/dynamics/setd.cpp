#include "odpd/dynamics/setd.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "odpd/core/index.h"
#include "odpd/operator/edge_sums.h"

namespace odpd {

namespace {

struct Phi {
  double e, phi_1, phi_2, phi_3;
};

// exp(-x) and the phi functions of -x; series where the quotients would lose their digits.
Phi phi_of(double x) {
  Phi p{};
  p.e = std::exp(-x);
  if (x < 1e-2) {
    p.phi_3 = 1.0 / 6.0 - x / 24.0 + x * x / 120.0 - x * x * x / 720.0;
    p.phi_2 = 0.5 - x * p.phi_3;
    p.phi_1 = 1.0 - x * p.phi_2;
  } else {
    p.phi_1 = -std::expm1(-x) / x;
    p.phi_2 = (1.0 - p.phi_1) / x;
    p.phi_3 = (0.5 - p.phi_2) / x;
  }
  return p;
}

// What one particle goes into the step with, D numbers each.
template <int D>
struct Particle {
  using Vector = Eigen::Matrix<double, D, 1>;
  Vector v, n, dn;  // velocity, N + xi, dN
};

// Writes v' and displacement/dt, D numbers each.
template <int D>
void advance(const Eigen::Matrix<double, D, D>& friction, double dt, double mass,
             const Particle<D>& p, double* v_end, double* v_mid) {
  using Vector = typename Particle<D>::Vector;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, D, D>> modes;
  modes.computeDirect(friction);
  const auto& q = modes.eigenvectors();
  const Vector v = q.transpose() * p.v, n = q.transpose() * p.n, dn = q.transpose() * p.dn;
  Vector end, mid;
  for (int c = 0; c < D; ++c) {
    const Phi f = phi_of(std::max(modes.eigenvalues()[c], 0.0) * dt / mass);
    end[c] = f.e * v[c] + dt / mass * (f.phi_1 * n[c] + f.phi_2 * dn[c]);
    mid[c] = f.phi_1 * v[c] + dt / mass * (f.phi_2 * n[c] + f.phi_3 * dn[c]);
  }
  end = q * end;
  mid = q * mid;
  std::copy(end.begin(), end.end(), v_end);
  std::copy(mid.begin(), mid.end(), v_mid);
}

}  // namespace

template <int D>
const StepRecord<D>& Setd<D>::step(Dynamics<D>& dynamics, const Clock& clock) {
  auto& record = this->record_;
  Motion<D>& motion = dynamics.motion();
  this->begin(dynamics, clock);
  const double zeta_0 = dynamics.constants().zeta_0;
  std::vector<double> v = motion.end_velocity(record.start);
  const std::vector<double> xi =
      dynamics.draw_noise(record.start, clock.step, clock.dt, record.edge_noise);
  record.start.velocity = motion.velocities(record.start, v);
  const std::vector<double> force = dynamics.total_force(record.start, v);
  const bool lagged = !last_velocity_.empty();
  const std::vector<double> last_v = lagged ? last_velocity_.unknowns(dynamics) : v;
  const std::vector<double> last_force = lagged ? last_force_.unknowns(dynamics) : force;
  const std::vector<double> v_before = v;

  PhaseTimer timer(dynamics.phases(), Phase::solve);
  std::vector<std::array<double, index(D * D)>> blocks(record.start.position.size());
  add_friction_blocks<D>(record.start.network, blocks);
  using Matrix = Eigen::Matrix<double, D, D>;
  using Vector = typename Particle<D>::Vector;
  std::vector<double> q_mid(v.size());
  for (std::size_t n = 0; n < index(dynamics.dofs().nodes()); ++n) {
    const auto i = index(dynamics.dofs().particle_of(n));
    const Matrix a = Eigen::Map<const Matrix>(blocks[i].data()) + zeta_0 * Matrix::Identity();
    const auto at = [&](const std::vector<double>& u) {
      return Eigen::Map<const Vector>(&u[n * D]);
    };
    // With the A of this step at both times, so that dN is a difference of the same N(t).
    Particle<D> p{at(v), at(force) + a * at(v), Vector::Zero()};
    if (lagged) p.dn = p.n - (at(last_force) + a * at(last_v));
    p.n += at(xi);
    advance<D>(a, clock.dt, dynamics.constants().mass, p, &v[n * D], &q_mid[n * D]);
  }
  record.v_mid = motion.velocities(record.start, q_mid);
  record.alarm_crossings += motion.move(record.v_mid, clock.dt, clock.time());
  if (order_ > 1) {
    std::vector<double> last = v_before;
    motion.cross_faces(last);
    last_velocity_.keep(dynamics, last);
    last_force_.keep(dynamics, force);
  }
  motion.set_end_momentum(v);
  return record;
}

template <int D>
void Setd<D>::prepare(Dynamics<D>& dynamics) {
  if (order_ < 2) return;
  for (auto* kept : {&last_velocity_, &last_force_}) kept->prepare(dynamics);
}

template <int D>
void Setd<D>::save(StateWriter& out) const {
  for (const auto* kept : {&last_velocity_, &last_force_}) kept->save(out);
}

template <int D>
void Setd<D>::load(const StateReader& in) {
  for (auto* kept : {&last_velocity_, &last_force_}) kept->load(in);
}

template class Setd<2>;
template class Setd<3>;

}  // namespace odpd
