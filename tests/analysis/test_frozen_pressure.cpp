// A pressure in what frozen configurations answer to loads, against dense matrices of friction and of hat functions.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "frozen_steps.h"
#include "odpd/analysis/force_points.h"
#include "odpd/analysis/frozen.h"
#include "odpd/core/parallel.h"
#include "odpd/operator/edge_sums.h"
#include "records.h"
#include "support/dimensions.h"
#include "support/errors.h"
#include "support/simplex.h"

namespace {

using frozen_steps::dense_solution;
using frozen_steps::OneStep;
using odpd::FrozenPressure;
using odpd::index;
using odpd::Vec;

using Matrix = std::vector<std::vector<double>>;

template <int D>
using EdgeVectors = std::vector<Vec<D>>;

/// Slips J u.
template <int D>
EdgeVectors<D> slips_of(const odpd::PairNetwork<D>& network, const std::vector<Vec<D>>& u) {
  EdgeVectors<D> slips;
  for (std::size_t k = 0; k < network.i.size(); ++k)
    slips.push_back(u[index(network.i[k])] - u[index(network.j[k])]);
  return slips;
}

template <int D>
std::vector<Vec<D>> forces_of(const odpd::PairNetwork<D>& network, const EdgeVectors<D>& edge) {
  std::vector<Vec<D>> force(index(network.particles));
  for (std::size_t k = 0; k < edge.size(); ++k) {
    force[index(network.i[k])] += edge[k];
    force[index(network.j[k])] -= edge[k];
  }
  return force;
}

/// The hat function of node g at r: along each direction 1 at its node and 0 at the next ones; `periodic` in L, else nodes from
/// `low` on.
double hat(double x, double node, double cell, double period) {
  double d = x - node;
  if (period > 0.0) d = std::remainder(d, period);
  return std::max(0.0, 1.0 - std::abs(d) / cell);
}

/// Nodes along each direction from the free particles' extent or the box's, as they are wanted, and C as a matrix.
template <int D>
struct BruteForce {
  explicit BruteForce(OneStep<D>& step, double spacing = 1.0) : step_(step) {
    const auto& stage = step.record.start;
    const auto& particles = step.scene.particles();
    for (int c = 0; c < D; ++c) {
      const bool periodic = stage.box.is_periodic(c);
      low[index(c)] = periodic ? 0.0 : 1e9;
      double high = periodic ? stage.box.size[c] : -1e9;
      for (std::size_t i = 0; i < stage.position.size() && !periodic; ++i) {
        if (!particles.is_free(i)) continue;
        low[index(c)] = std::min(low[index(c)], stage.position[i][c]);
        high = std::max(high, stage.position[i][c]);
      }
      const double cells = std::round((high - low[index(c)]) / spacing);
      cell[index(c)] = (high - low[index(c)]) / cells;
      count[index(c)] = static_cast<int>(cells) + (periodic ? 0 : 1);
      nodes *= index(count[index(c)]);
    }
    // R w = J^T c e, and the tension that is left.
    const auto& network = stage.network;
    for (std::size_t k = 0; k < network.i.size(); ++k)
      tension.push_back(-2.0 * (1.0 - network.r[k]) * free_ends(k) * network.e[k]);
    const std::vector<double> w = solve(step.matrix, unknowns(forces_of(network, tension)));
    const EdgeVectors<D> slips = slips_of(network, velocities(w));
    for (std::size_t k = 0; k < network.i.size(); ++k)
      tension[k] += odpd::friction_of<D>(network, k, slips[k]);
  }
  int free_ends(std::size_t k) const {
    const auto& network = step_.record.start.network;
    const auto& particles = step_.scene.particles();
    return (particles.is_free(index(network.i[k])) ? 1 : 0) +
           (particles.is_free(index(network.j[k])) ? 1 : 0);
  }
  double hat_at(std::size_t i, std::size_t node) const {
    const auto& stage = step_.record.start;
    double h = 1.0;
    for (int c = D - 1; c >= 0; --c) {
      const auto n = index(count[index(c)]);
      const double period = stage.box.is_periodic(c) ? stage.box.size[c] : 0.0;
      // Boxes of one or two cells would meet the same node from both sides.
      EXPECT_TRUE(period == 0.0 || n > 1);
      h *= hat(stage.position[i][c], low[index(c)] + cell[index(c)] * static_cast<double>(node % n),
               cell[index(c)], period);
      node /= n;
    }
    return h;
  }
  /// (C s)_g.
  std::vector<double> rates(const EdgeVectors<D>& slips) const {
    const auto& network = step_.record.start.network;
    const auto& particles = step_.scene.particles();
    std::vector<double> sums(nodes);
    for (std::size_t k = 0; k < slips.size(); ++k) {
      const auto i = index(network.i[k]), j = index(network.j[k]);
      const int ends = free_ends(k);
      for (std::size_t g = 0; g < nodes; ++g) {
        double h = 0.0;
        if (ends != 1) {
          h = 0.5 * (hat_at(i, g) + hat_at(j, g));
        } else {
          h = hat_at(particles.is_free(i) ? i : j, g);
        }
        sums[g] += h * dot(tension[k], slips[k]);
      }
    }
    return sums;
  }
  std::vector<Vec<D>> velocities(const std::vector<double>& q) const {
    const auto& stage = step_.record.start;
    std::vector<Vec<D>> v;
    step_.dynamics.dofs().scatter(stage.arms, q, std::vector<Vec<D>>(stage.position.size()), v);
    return v;
  }
  std::vector<double> unknowns(const std::vector<Vec<D>>& forces) const {
    return step_.of_forces([&](std::size_t i) { return forces[i]; });
  }
  std::vector<double> solve(const Matrix& matrix, const std::vector<double>& load) const {
    return dense_solution(matrix, step_.nulls, load);
  }
  /// u and p of R u + G p = f, G^T u = -b: the pressure of a uniform compression is left at 0 by one more null vector.
  std::pair<std::vector<double>, std::vector<double>> saddle(const std::vector<double>& f,
                                                             const std::vector<double>& b) const {
    const std::size_t n = f.size();
    Matrix matrix(n + nodes, std::vector<double>(n + nodes));
    Matrix nulls = step_.nulls;
    for (auto& v : nulls) v.resize(n + nodes);
    std::vector<double> all(f);
    all.resize(n + nodes);
    for (std::size_t k = 0; k < n; ++k) {
      std::vector<double> q(n);
      q[k] = 1.0;
      const std::vector<double> column = rates(slips_of(step_.record.start.network, velocities(q)));
      for (std::size_t m = 0; m < n; ++m) matrix[m][k] = step_.matrix[m][k];
      for (std::size_t g = 0; g < nodes; ++g) matrix[n + g][k] = matrix[k][n + g] = column[g];
    }
    for (std::size_t g = 0; g < nodes; ++g) all[n + g] = -b[g];
    nulls.emplace_back(n + nodes);
    for (std::size_t g = 0; g < nodes; ++g) nulls.back()[n + g] = 1.0;
    std::vector<double> x = dense_solution(matrix, nulls, all);
    const std::vector<double> p(x.begin() + static_cast<std::ptrdiff_t>(n), x.end());
    x.resize(n);
    return {x, p};
  }

  OneStep<D>& step_;
  std::array<double, D> low{}, cell{};
  std::array<int, D> count{};
  std::size_t nodes = 1;
  EdgeVectors<D> tension;
};

template <int D>
odpd::SceneSettings<D> fluid_with_bodies() {
  auto s = frozen_steps::some_fluid<D>();
  s.bodies = {frozen_steps::body_of<D>(support::simplex_body<D>().frame, 2)};
  return s;
}

template <class T>
class FrozenPressureTest : public ::testing::Test {};
TYPED_TEST_SUITE(FrozenPressureTest, support::Dimensions);

double largest(const std::vector<double>& x) {
  double most = 0.0;
  for (const double value : x) most = std::max(most, std::abs(value));
  return most;
}

template <int D>
double largest(const std::vector<Vec<D>>& x) {
  double most = 0.0;
  for (const Vec<D>& v : x) most = std::max(most, norm(v));
  return most;
}

// In a periodic box and between walls, where nodes begin and end with the free particles.
TYPED_TEST(FrozenPressureTest, RatesAreThoseOfHatFunctions) {
  constexpr int D = TypeParam::D;
  for (const bool walls : {false, true}) {
    SCOPED_TRACE(walls);
    auto settings = fluid_with_bodies<D>();
    if (walls) {
      settings.box.size[1] = 3.0;
      records::add_walls(settings, 0.0);
    }
    OneStep<D> step(settings);
    if (walls) step.nulls.erase(step.nulls.begin(), step.nulls.begin() + D);
    const BruteForce<D> brute(step);
    const FrozenPressure<D> pressure(step.scene.particles(), step.record, {.reach = 1.0}, 1.0,
                                     1e-11);
    ASSERT_EQ(pressure.nodes(), brute.nodes);
    const auto slips = support::random_vectors<D>(index(step.record.start.network.size()), 5);
    const std::vector<double> exact = brute.rates(slips), rates = pressure.rates(slips);
    for (std::size_t g = 0; g < exact.size(); ++g)
      EXPECT_NEAR(rates[g], exact[g], 1e-8 * largest(exact));
  }
}

// p . G^T u = (G p) . u; uniform motion has no rates, no pressure a net force, and one pressure everywhere pushes nobody: neither a free
// particle nor a body.
TYPED_TEST(FrozenPressureTest, PushesAsItSeesMotion) {
  constexpr int D = TypeParam::D;
  OneStep<D> step(fluid_with_bodies<D>());
  const FrozenPressure<D> pressure(step.scene.particles(), step.record, {.reach = 1.0}, 1.0, 1e-11);
  const std::size_t n = step.record.start.position.size();
  const std::vector<double> p = support::random_numbers(pressure.nodes(), 7);
  const auto u = support::random_vectors<D>(n, 8);
  const std::vector<double> rates = pressure.rates_of({u});
  const std::vector<Vec<D>> push = pressure.push(p).force;
  double of_rates = 0.0, of_push = 0.0;
  Vec<D> net{};
  for (std::size_t g = 0; g < p.size(); ++g) of_rates += p[g] * rates[g];
  for (std::size_t i = 0; i < n; ++i) {
    of_push -= dot(push[i], u[i]);
    net += push[i];
  }
  EXPECT_GT(std::abs(of_rates), 0.1);
  EXPECT_NEAR(of_rates, of_push, 1e-10 * std::abs(of_rates));
  EXPECT_LT(norm(net), 1e-12 * largest<D>(push));
  EXPECT_LT(largest(pressure.rates_of({std::vector<Vec<D>>(n, support::uniform_vec<D>(2.0))})),
            1e-12 * largest(rates));
  const std::vector<Vec<D>> still = pressure.push(std::vector<double>(pressure.nodes(), 1.0)).force;
  EXPECT_GT(largest<D>(push), 0.1);
  EXPECT_LT(largest(step.of_forces([&](std::size_t i) { return still[i]; })),
            1e-8 * largest<D>(push));
}

// Of forces: f.u of the saddle point, and no rates are left. With the observers' tolerance the value is right to less than a thousandth.
TYPED_TEST(FrozenPressureTest, MobilityIsThatOfTheSaddlePoint) {
  constexpr int D = TypeParam::D;
  OneStep<D> step(fluid_with_bodies<D>());
  const BruteForce<D> brute(step);
  auto force = support::random_vectors<D>(step.record.start.position.size(), 9);
  Vec<D> mean{};
  for (const Vec<D>& f : force) mean += (1.0 / static_cast<double>(force.size())) * f;
  for (Vec<D>& f : force) f -= mean;
  const std::vector<double> f = brute.unknowns(force);
  const auto [u, p] = brute.saddle(f, std::vector<double>(brute.nodes));
  double exact = 0.0;
  for (std::size_t k = 0; k < f.size(); ++k) exact += f[k] * u[k];
  const auto answer = [&](double tolerance, const FrozenPressure<D>* pressure) {
    return odpd::answer_to_force<D>(step.scene.particles(), step.record, {force}, 0.0, tolerance,
                                    pressure);
  };
  EXPECT_GT(answer(1e-10, nullptr).mobility, 1.02 * exact);
  for (const double tolerance : {1e-10, 0.01}) {
    SCOPED_TRACE(tolerance);
    const FrozenPressure<D> pressure(step.scene.particles(), step.record, {.reach = 1.0}, 1.0,
                                     tolerance);
    const auto held = answer(tolerance, &pressure);
    EXPECT_NEAR(held.mobility, exact, (tolerance < 1e-3 ? 1e-7 : 5e-4) * exact);
    if (tolerance > 1e-3) continue;
    auto motions = step.record.respond({force}, tolerance);
    std::vector<double> rates = pressure.rates_of(motions);
    const auto found = pressure.hold(rates, motions, exact, tolerance).pressure;
    for (std::size_t g = 1; g < p.size(); ++g)
      EXPECT_NEAR(found[g] - found[0], p[g] - p[0], 1e-4 * largest(p));
    EXPECT_LT(largest(pressure.rates_of(held)),
              1e-4 * largest(pressure.rates_of(answer(tolerance, nullptr))));
  }
}

// A box narrower than the spacing has two nodes along it still: one alone would leave friction as it is, without a word.
TYPED_TEST(FrozenPressureTest, NarrowBoxesHaveAPressureToo) {
  constexpr int D = TypeParam::D;
  OneStep<D> step(fluid_with_bodies<D>());
  const double wide = 10.0 * step.record.start.box.size[0];
  const FrozenPressure<D> pressure(step.scene.particles(), step.record, {.reach = 1.0}, wide, 1e-8);
  EXPECT_EQ(pressure.nodes(), 1U << D);
  auto force = support::random_vectors<D>(step.record.start.position.size(), 9);
  const auto mobility = [&](const FrozenPressure<D>* with) {
    return odpd::answer_to_force<D>(step.scene.particles(), step.record, {force}, 0.0, 1e-8, with)
        .mobility;
  };
  EXPECT_LT(mobility(&pressure), 0.999 * mobility(nullptr));
}

// Of flows: V eta of the saddle point, but for the rate of the whole, which no motion changes.
TYPED_TEST(FrozenPressureTest, ViscosityIsThatOfTheSaddlePoint) {
  constexpr int D = TypeParam::D;
  OneStep<D> step(fluid_with_bodies<D>());
  const BruteForce<D> brute(step);
  const auto& stage = step.record.start;
  const odpd::ForcePoints<D> points(step.scene.particles(), stage);
  const auto E = odpd::shear_gradient<D>(0, 1);
  EdgeVectors<D> flow(index(stage.network.size())), friction(flow);
  for (std::size_t k = 0; k < flow.size(); ++k) {
    flow[k][0] = points.between(stage.network, k)[1];
    friction[k] = odpd::friction_of<D>(stage.network, k, flow[k]);
  }
  const FrozenPressure<D> pressure(step.scene.particles(), step.record, {.reach = 1.0}, 1.0, 1e-10);
  std::vector<double> rates = brute.rates(flow);
  EXPECT_GT(largest(rates), 0.1);
  pressure.drop_whole(rates);
  double whole = 0.0;
  for (const double rate : rates) whole += rate;
  EXPECT_NEAR(whole, 0.0, 1e-12 * largest(rates));
  const auto [u, p] = brute.saddle(brute.unknowns(forces_of(stage.network, friction)), rates);
  const EdgeVectors<D> more = slips_of(stage.network, brute.velocities(u));
  double exact = 0.0;
  for (std::size_t k = 0; k < flow.size(); ++k) {
    const Vec<D> slip = flow[k] + more[k];
    exact -= dot(slip, odpd::friction_of<D>(stage.network, k, slip));
  }
  const auto power = [&](const FrozenPressure<D>* with) {
    return odpd::answer_to_flow<D>(step.scene.particles(), step.record, E, 1e-10, with).power;
  };
  EXPECT_NEAR(power(&pressure), exact, 1e-7 * exact);
  EXPECT_LT(1.002 * power(nullptr), exact);
}

// The same configuration moved by one cell of the grid along the edge of the cell that is tilted where images slide: through the face, where
// particles come out elsewhere.
TYPED_TEST(FrozenPressureTest, GridIsTiltedWithSlidingImages) {
  constexpr int D = TypeParam::D;
  auto settings = frozen_steps::some_fluid<D>();
  settings.box.shear = odpd::Shear{.flow = 0, .gradient = 1, .rate = 1.0, .start = 0.8};
  if (D == 3) settings.box.size = support::uniform_vec<D>(3.0);
  settings.count = D == 2 ? 40 : 100;
  settings.start = odpd::StartKind::file;
  settings.relax_sweeps = 0;
  settings.start_positions =
      support::random_points<D>(Vec<D>{}, settings.box.size, index(settings.count), 4);
  const auto force = support::random_vectors<D>(index(settings.count), 5);
  const auto answer = [&] {
    OneStep<D> step(settings);
    std::vector<Vec<D>> sorted;
    for (const auto id : step.scene.particles().id) sorted.push_back(force[index(id)]);
    const FrozenPressure<D> pressure(step.scene.particles(), step.record, {.reach = 1.0}, 1.0,
                                     1e-10);
    return odpd::answer_to_force<D>(step.scene.particles(), step.record, {sorted}, 0.0, 1e-10,
                                    &pressure)
        .mobility;
  };
  const double before = answer();
  const odpd::Box<D> box = settings.box.at(0.0);
  const double cell = 1.0;
  for (Vec<D>& r : settings.start_positions) {
    r[0] += box.offset * cell / box.size[1];
    r[1] += cell;
    box.wrap(r);
  }
  EXPECT_NEAR(answer(), before, 1e-6 * before);
}

TEST(FrozenPressureThreads, DoNotChangeItsBits) {
  auto settings = frozen_steps::some_fluid<2>();
  settings.box.size = support::uniform_vec<2>(14.0);
  settings.count = 700;
  const odpd::Scene<2> scene(settings);
  const auto answer = [&](int threads) {
    odpd::set_threads(threads, 0);
    odpd::Scene<2> own(settings);
    odpd::Dynamics<2> dynamics(own.box(), own.particles(), own.model(), own,
                               odpd::make_solver({.name = "pcg", .tolerance = 1e-6}), {.seed = 3});
    const auto integrator = odpd::make_integrator<2>("trapezoidal");
    const auto record = integrator->step(dynamics, odpd::Clock{.dt = 0.005});
    const FrozenPressure<2> pressure(own.particles(), record, {.reach = 1.0}, 1.0, 0.01);
    return odpd::answer_to_flow<2>(own.particles(), record, odpd::shear_gradient<2>(0, 1), 0.01,
                                   &pressure)
        .power;
  };
  const double one = answer(1);
  EXPECT_EQ(answer(3), one);
  odpd::set_threads(1, 0);
}

// Two lines of particles that each close through the box, out of W's reach of each other: a shear makes each longer as a whole, one more than the
// other for what it weighs, and nothing can change either.
TEST(FrozenPressureOfLines, IsRefused) {
  std::vector<Vec<2>> r;
  for (int k = 0; k < 5; ++k) r.push_back({{0.6 * k + 0.05, 0.6 * k + 0.05}});
  for (int k = 0; k < 6; ++k) r.push_back({{0.5 * k + 0.05, std::fmod(0.5 * k + 1.55, 3.0)}});
  auto settings = records::periodic<2>(3.0, r);
  settings.model = odpd::make_dpd<2>({.a = 0.0, .gamma = 2.0, .gamma_perp = 1.0, .cutoff = 1.2});
  OneStep<2> step(settings);
  ASSERT_GT(step.record.start.network.size(), 11);
  const FrozenPressure<2> pressure(step.scene.particles(), step.record, {.reach = 1.0}, 0.3, 1e-8);
  support::expect_error<odpd::SolverError>(
      [&] {
        odpd::answer_to_flow<2>(step.scene.particles(), step.record, odpd::shear_gradient<2>(0, 1),
                                1e-8, &pressure);
      },
      {"no pressure", "11 free particles", "100 nodes", "incompressible = false"});
}

}  // namespace
