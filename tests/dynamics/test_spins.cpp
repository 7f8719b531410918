// Particles that spin: what is conserved, what moves without resistance, and the random torques.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/pairs/noise.h"
#include "support/dimensions.h"
#include "support/spinning.h"

namespace odpd {
namespace {

using support::Spinning;
using support::SpinningSettings;

template <class Dim>
class Spins : public testing::Test {};
TYPED_TEST_SUITE(Spins, support::Dimensions);

template <int D>
double largest_spin(const std::vector<Vec<D>>& w) {
  double most = 0.0;
  for (const Vec<D>& spin : w) most = std::max(most, norm(spin));
  return most;
}

/// A symmetric matrix without negative eigenvalues, row by row.
struct DenseMatrix {
  std::size_t n;
  std::vector<double> a;

  double& at(std::size_t i, std::size_t j) { return a[i * n + j]; }
  double at(std::size_t i, std::size_t j) const { return a[i * n + j]; }
  /// By pivots, largest first, down to 1e-10 of the first.
  std::size_t null_dimension() const {
    DenseMatrix m = *this;
    double most = 0.0;
    std::vector<char> done(n);
    for (std::size_t rank = 0; rank < n; ++rank) {
      std::size_t p = n;
      for (std::size_t i = 0; i < n; ++i)
        if (!done[i] && (p == n || m.at(i, i) > m.at(p, p))) p = i;
      const double pivot = m.at(p, p);
      most = std::max(most, pivot);
      if (pivot < 1e-10 * most || most == 0.0) return n - rank;
      done[p] = 1;
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
          if (!done[i] && !done[j]) m.at(i, j) -= m.at(i, p) * m.at(p, j) / pivot;
    }
    return 0;
  }
};

/// R of all velocities and spins of a stage, of a spin the components that mean something, as sums over edges have it.
template <int D>
DenseMatrix resistance_of(Dynamics<D>& dynamics, const Stage<D>& stage) {
  const DofMap<D>& dofs = dynamics.dofs();
  std::vector<std::size_t> rows;
  for (std::size_t k = 0; k < index(dofs.unknowns()); ++k)
    if (k >= index(dofs.spins()) * D || k % D < index(rotation_components<D>)) rows.push_back(k);
  DenseMatrix matrix{rows.size(), std::vector<double>(rows.size() * rows.size())};
  for (std::size_t j = 0; j < rows.size(); ++j) {
    std::vector<double> q(index(dofs.unknowns()));
    q[rows[j]] = 1.0;
    const std::vector<double> f = dynamics.friction(stage, q);
    for (std::size_t i = 0; i < rows.size(); ++i) matrix.at(i, j) = f[rows[i]];
  }
  return matrix;
}

// Of friction and conservative forces of both stages of a step, and of the noise.
TYPED_TEST(Spins, ForcesAndTorquesOfAllEdgesAddUpToNothing) {
  constexpr int D = TypeParam::D;
  Spinning<D> toy({.mass = 0.7, .moment = 0.05});
  const auto expect_balance = [](const Stage<D>& stage, const std::vector<Vec<D>>& edge_force) {
    std::vector<Vec<D>> force(stage.position.size()), turning(force.size());
    add_edge_forces<D>(stage.network, edge_force, force);
    add_edge_torques<D>(stage.network, edge_force, turning);
    Vec<D> total{}, moment{};
    double forces = 0.0, moments = 0.0;
    for (std::size_t i = 0; i < force.size(); ++i) {
      total += force[i];
      moment += torque(stage.position[i], force[i]) + turning[i];
      forces += norm(force[i]);
      moments += norm(torque(stage.position[i], force[i])) + norm(turning[i]);
    }
    EXPECT_GT(norm(turning[0]), 0.0);
    EXPECT_LT(norm(total), 1e-12 * forces);
    EXPECT_LT(norm(moment), 1e-12 * moments);
  };
  const auto integrator = make_integrator<D>("trapezoidal");
  for (Clock clock{.dt = 0.01, .total_steps = 5}; !clock.finished(); clock.advance()) {
    const StepRecord<D>& record = integrator->step(*toy.dynamics, clock);
    for (const Stage<D>* stage : {&record.start, &record.corrector})
      expect_balance(*stage, toy.edge_forces(*stage));
    expect_balance(record.start, record.edge_noise);
  }
}

// Exchanges keep r x v + I w of pairs, and no path along v changes it: that of a run is kept to rounding. Of velocity-verlet it is that of
// the velocities half-way, at the places that they lead to.
TYPED_TEST(Spins, ExplicitSchemesKeepAngularMomentumThroughARun) {
  constexpr int D = TypeParam::D;
  for (const char* scheme : {"shardlow", "velocity-verlet"}) {
    Spinning<D> toy({.mass = 0.7, .moment = 0.05});
    const auto integrator = make_integrator<D>(scheme);
    integrator->prepare(*toy.dynamics);
    Vec<D> first{};
    for (Clock clock{.dt = 0.005, .total_steps = 40}; !clock.finished(); clock.advance()) {
      const StepRecord<D>& record = integrator->step(*toy.dynamics, clock);
      const Vec<D> now = toy.angular_momentum(toy.particles.position, record.v_mid, record.w_mid);
      if (clock.step == 0) first = now;
      EXPECT_LT(norm(now - first), 1e-12 * static_cast<double>(clock.step + 2) * (1.0 + norm(now)))
          << scheme << " " << clock.step;
    }
    EXPECT_GT(largest_spin(toy.particles.spin), 0.1) << scheme;
  }
}

// Translations; in an open box rotations u = W x r with all w = W; and where friction along e is missing, dilation.
TYPED_TEST(Spins, MovesWithoutResistanceAsARigidBodyAlone) {
  constexpr int D = TypeParam::D;
  constexpr std::size_t turns = D == 2 ? 1 : 3, count = 12;
  const auto null_dimension = [](double gamma, double gamma_perp, bool periodic) {
    Spinning<D> toy({.fluid = {.a = 0.0, .gamma = gamma, .gamma_perp = gamma_perp, .cutoff = 1.5},
                     .count = periodic ? 4 * count : count,
                     .edge = periodic ? 3.1 : 1.2,
                     .periodic = periodic});
    Stage<D> stage;
    toy.dynamics->evaluate(toy.particles.position, 0.0, stage);
    return resistance_of(*toy.dynamics, stage).null_dimension();
  };
  EXPECT_EQ(null_dimension(3.0, 2.0, false), D + turns);
  EXPECT_EQ(null_dimension(3.0, 2.0, true), index(D));
  EXPECT_EQ(null_dimension(3.0, 0.0, false), turns * count + D + turns) << "nothing turns them";
  EXPECT_EQ(null_dimension(0.0, 2.0, false), D + turns + 1);
}

// 20000 draws for each entry: bounds of five standard errors.
TYPED_TEST(Spins, NoiseHasTheCovarianceOfTheResistanceInAllUnknowns) {
  constexpr int D = TypeParam::D;
  constexpr double dt = 0.02, kT = 1.3;
  constexpr std::int64_t draws = 20000;
  Spinning<D> toy({.fluid = {.gamma = 3.0, .gamma_perp = 5.0, .kT = kT}, .count = 3, .edge = 0.6});
  Stage<D> stage;
  toy.dynamics->evaluate(toy.particles.position, 0.0, stage);
  ASSERT_EQ(stage.network.size(), 3);
  const DenseMatrix R = resistance_of(*toy.dynamics, stage);
  DenseMatrix sum{R.n, std::vector<double>(R.a.size())};
  std::vector<Vec<D>> edge_noise;
  for (std::int64_t step = 0; step < draws; ++step) {
    const std::vector<double> all = toy.dynamics->draw_noise(stage, step, dt, edge_noise);
    std::vector<double> xi;
    for (std::size_t k = 0; k < all.size(); ++k)
      if (k >= 3 * D || k % D < index(rotation_components<D>)) xi.push_back(all[k]);
    for (std::size_t i = 0; i < R.n; ++i)
      for (std::size_t j = 0; j < R.n; ++j) sum.at(i, j) += xi[i] * xi[j];
  }
  const double scale = 2.0 * kT / dt;
  for (std::size_t i = 0; i < R.n; ++i)
    for (std::size_t j = 0; j < R.n; ++j) {
      const double error =
          scale * std::sqrt((R.at(i, i) * R.at(j, j) + R.at(i, j) * R.at(i, j)) / draws);
      EXPECT_NEAR(sum.at(i, j) / draws, scale * R.at(i, j), 5.0 * error) << i << " " << j;
    }
}

// F = [A dW^S + B tr(dW)/d + C dW^A] e with the traceless symmetric and the antisymmetric part of a matrix of independent numbers
// (Espanol & Revenga 2003, section on spin in Ellero & Espanol 2018): in law one Gaussian vector per edge, so two of its three amplitudes are enough.
TYPED_TEST(Spins, NoiseOfAnEdgeIsThatOfTheMatricesOfTheLiterature) {
  constexpr int D = TypeParam::D;
  constexpr double dt = 0.02, kT = 1.0;
  constexpr std::size_t draws = 40000;
  const DpdParameters fluid{.a = 0.0, .gamma = 3.0, .gamma_perp = 2.0, .s = 0.0, .kT = kT};
  Spinning<D> toy({.fluid = fluid, .radii = {0.4, 0.9}, .count = 2, .edge = 0.4});
  Stage<D> stage;
  toy.dynamics->evaluate(toy.particles.position, 0.0, stage);
  ASSERT_EQ(stage.network.size(), 1);
  const Vec<D> e = stage.network.e[0];
  // (A^2 + C^2)/2 across, and (A^2 - C^2)/2 + (B^2 - A^2)/d more along, of unequal A and C.
  const double across = 2.0 * kT * fluid.gamma_perp / dt, along = 2.0 * kT * fluid.gamma / dt;
  const double A2 = 1.4 * across, C2 = 0.6 * across;
  const double B2 = A2 + D * (along - across - 0.5 * (A2 - C2));
  ASSERT_GT(B2, 0.0);
  const std::vector<double> numbers = support::random_numbers(draws * D * D, 8);
  std::array<double, D * D> by_matrix{}, by_edge{};
  std::vector<Vec<D>> noise;
  for (std::size_t n = 0; n < draws; ++n) {
    const auto w = [&](int a, int b) { return numbers[(n * D + index(a)) * D + index(b)]; };
    double trace = 0.0;
    for (int c = 0; c < D; ++c) trace += w(c, c);
    Vec<D> f{};
    for (int a = 0; a < D; ++a)
      for (int b = 0; b < D; ++b) {
        const double symmetric = 0.5 * (w(a, b) + w(b, a)) - (a == b ? trace / D : 0.0);
        f[a] += (std::sqrt(A2) * symmetric + std::sqrt(C2) * 0.5 * (w(a, b) - w(b, a)) +
                 (a == b ? std::sqrt(B2) * trace / D : 0.0)) *
                e[b];
      }
    draw_edge_noise(stage.network, toy.particles, 3, n, dt, noise);
    for (int a = 0; a < D; ++a)
      for (int b = 0; b < D; ++b) {
        by_matrix[index(a * D + b)] += f[a] * f[b] / draws;
        by_edge[index(a * D + b)] += noise[0][a] * noise[0][b] / draws;
      }
  }
  for (int a = 0; a < D; ++a)
    for (int b = 0; b < D; ++b) {
      const double exact = (a == b ? across : 0.0) + (along - across) * e[a] * e[b];
      // Of variances 2 along^2 at most.
      const double bound = 5.0 * along * std::sqrt(2.0 / draws);
      EXPECT_NEAR(by_matrix[index(a * D + b)], exact, bound) << a << b;
      EXPECT_NEAR(by_edge[index(a * D + b)], exact, bound) << a << b;
    }
}

// With I = 0 the torques on each particle balance, so the virial of edge forces is symmetric: to the solver's tolerance, under shear, with noise.
TYPED_TEST(Spins, WithoutInertiaTheStressIsSymmetric) {
  constexpr int D = TypeParam::D;
  const auto asymmetry = [](const std::vector<double>& radii) {
    Spinning<D> toy({.radii = radii,
                     .count = D == 2 ? 60 : 140,
                     .edge = D == 2 ? 4.0 : 3.2,
                     .periodic = true,
                     .shear = Shear{1, 0, 2.0, 0.0, 0.0}});
    const auto integrator = make_integrator<D>("trapezoidal");
    const StepRecord<D>& record = integrator->step(*toy.dynamics, {.dt = 0.005, .total_steps = 1});
    const auto excess = [](const Stage<D>& stage, const std::vector<Vec<D>>& force) {
      double sum = 0.0;
      for (std::size_t k = 0; k < force.size(); ++k) {
        const Vec<D>& e = stage.network.e[k];
        sum += stage.network.r[k] * (e[1] * force[k][0] - e[0] * force[k][1]);
      }
      return sum;
    };
    double forces = 0.0;
    for (std::size_t k = 0; k < record.edge_noise.size(); ++k)
      forces += record.start.network.r[k] * norm(record.edge_noise[k]);
    // Both stages have the noise of the first.
    const double of_noise = excess(record.start, record.edge_noise);
    double worst = 0.0;
    for (const Stage<D>* stage : {&record.start, &record.corrector})
      worst =
          std::max(worst, std::abs(of_noise + excess(*stage, toy.edge_forces(*stage))) / forces);
    return worst;
  };
  EXPECT_LT(asymmetry({0.3, 1.0, 0.55}), 1e-9);
  EXPECT_GT(asymmetry({0.0}), 1e-3);
}

TEST(SpinSchemes, SomeCannotTurnParticles) {
  for (const std::string& name : integrator_names()) {
    EXPECT_EQ(spin_objection(name, false).empty(), name != "setd") << name;
    const bool by_moment = name == "setd" || name == "shardlow" || name == "velocity-verlet";
    EXPECT_EQ(spin_objection(name, true).empty(), !by_moment) << name;
  }
}

}  // namespace
}  // namespace odpd
