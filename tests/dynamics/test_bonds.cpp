// Bonds in a step: the order of implicit ones, and the energy of a trial move.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/dynamics/integrator.h"
#include "odpd/dynamics/local_energy.h"
#include "odpd/pairs/bonds.h"
#include "odpd/pairs/dpd.h"
#include "support/dimensions.h"
#include "support/points.h"

namespace odpd {
namespace {

// Order 2 without noise, with bonds implicit or not: a stretched chain of three in a fluid at rest.
TEST(ImplicitBonds, KeepTheOrder) {
  const auto end = [](const std::string& scheme, bool implicit_bonds, std::int64_t steps) {
    Box<2> box{{{5.0, 5.0}}, {true, true}};
    Particles<2> particles;
    for (int x = 0; x < 10; ++x)
      for (int y = 0; y < 10; ++y)
        particles.add({{0.5 * x + 0.1 + 0.1 * std::sin(3.0 * x + y),
                        0.5 * y + 0.1 + 0.1 * std::cos(2.0 * x - y)}},
                      0);
    for (Vec<2>& r : particles.position) box.wrap(r);
    const BondedModel<2> model(
        std::make_unique<DpdModel<2>>(
            1, std::vector{DpdParameters{.s_bar = 3.0, .s = 2.0, .kT = 0.0}}),
        {{44, 45, {.H = 100.0, .r_0 = 0.3}}, {45, 66, {.H = 100.0, .r_0 = 0.7}}});
    const NoSurroundings<2> nothing;
    Dynamics<2> dynamics(box, particles, model, nothing,
                         make_solver({.name = "pcg", .tolerance = 1e-12}), {.reorder_every = 0});
    IntegratorSettings settings;
    settings.name = scheme;
    settings.implicit_bonds = implicit_bonds;
    const auto integrator = make_integrator<2>(settings);
    for (Clock clock{.dt = 0.08 / static_cast<double>(steps), .total_steps = steps};
         !clock.finished(); clock.advance())
      integrator->step(dynamics, clock);
    return particles.position;
  };
  const auto distance = [](const std::vector<Vec<2>>& a, const std::vector<Vec<2>>& b) {
    double square = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) square += dot(a[i] - b[i], a[i] - b[i]);
    return std::sqrt(square);
  };
  const std::vector<Vec<2>> exact = end("trapezoidal", false, 1280);
  for (const char* scheme : {"trapezoidal", "midpoint"})
    for (const bool implicit_bonds : {true, false}) {
      const double coarse = distance(end(scheme, implicit_bonds, 80), exact);
      const double fine = distance(end(scheme, implicit_bonds, 160), exact);
      EXPECT_GT(coarse, 1e-8) << scheme;
      EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.25) << scheme << " " << implicit_bonds;
    }
}

template <class T>
class BondedEnergyTest : public ::testing::Test {};
TYPED_TEST_SUITE(BondedEnergyTest, support::Dimensions);

// What a trial move changes is what it changes in the energy of all edges.
TYPED_TEST(BondedEnergyTest, OfATrialMoveIsThatOfTheEdges) {
  constexpr int D = TypeParam::D;
  Box<D> box;
  box.size = support::uniform_vec<D>(3.0);
  box.periodic.fill(true);
  Particles<D> particles;
  for (const Vec<D>& r : support::random_points<D>(Vec<D>{}, box.size, 40, 5)) particles.add(r, 0);
  particles.reorder(support::random_order(40, 3));
  // 3 and 4 far apart, 5 and 6 close: beyond the cutoff and within.
  const auto index = particles.index_of_id();
  Vec<D>& far = particles.position[static_cast<std::size_t>(index[4])];
  far = particles.position[static_cast<std::size_t>(index[3])];
  far[0] += 1.2;
  box.wrap(far);
  particles.position[static_cast<std::size_t>(index[6])] =
      particles.position[static_cast<std::size_t>(index[5])] + support::uniform_vec<D>(0.1);
  box.wrap(particles.position[static_cast<std::size_t>(index[6])]);
  for (const BondExclusion exclude :
       {BondExclusion::none, BondExclusion::repulsion, BondExclusion::all}) {
    const BondedModel<D> model(std::make_unique<DpdModel<D>>(1, std::vector{DpdParameters{}}),
                               {{3, 4, {.H = 7.0, .r_0 = 0.2, .exclude = exclude}},
                                {5, 6, {.H = 7.0, .r_0 = 0.2, .exclude = exclude}}});
    const NoSurroundings<D> nothing;
    const auto energy = [&] {
      PairList<D> list(box, model.cutoff());
      list.update(particles.position);
      PairNetwork<D> network;
      model.write_edges(list, box, particles.position, particles, network);
      return network.u.sum();
    };
    LocalEnergy<D> local(box, model, nothing, particles);
    for (const std::int64_t id : {3, 5, 6, 20}) {
      const auto i = static_cast<std::size_t>(index[static_cast<std::size_t>(id)]);
      const Vec<D> from = particles.position[i];
      Vec<D> to = from + support::uniform_vec<D>(0.07);
      box.wrap(to);
      local.sort_in();
      const auto self = static_cast<std::int32_t>(i);
      const double change = local.change({&self, 1}, {&to, 1});
      const double before = energy();
      particles.position[i] = to;
      EXPECT_NEAR(change, energy() - before, 1e-10);
      particles.position[i] = from;
    }
  }
}

}  // namespace
}  // namespace odpd
