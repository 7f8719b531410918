// Which rigid motions of a group of particles meet no friction: counted where the answer is known, and R u = 0 for each.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/core/error.h"
#include "odpd/core/rotation.h"
#include "odpd/operator/rigid_resistance.h"
#include "support/dimensions.h"
#include "support/network.h"

namespace {

using namespace odpd;
using support::Fluid;

constexpr double edge_of_box = 6.0;

template <class T>
class FreeMotionsTest : public ::testing::Test {};
TYPED_TEST_SUITE(FreeMotionsTest, support::Dimensions);

template <int D>
void add_points(Fluid<D>& fluid, const Vec<D>& low, const Vec<D>& high, std::size_t count) {
  for (Vec<D> r : support::random_points<D>(low, high, count, 2)) {
    fluid.box.wrap(r);
    fluid.particles.add(r, 0);
  }
}

/// A drop whose middle is at `middle` along each axis.
template <int D>
struct Drop : Fluid<D> {
  explicit Drop(double middle) : Fluid<D>{edge_of_box, true} {
    add_points<D>(*this, support::uniform_vec<D>(middle - 0.6),
                  support::uniform_vec<D>(middle + 0.6), D == 2 ? 20 : 40);
  }
};

/// Null motions of the system, after checks of what every one of them must fulfil.
template <int D>
std::size_t count(Fluid<D>& fluid, const DpdModel<D>& model, double shift = 0.0,
                  std::span<const Vec<D>> arms = {}) {
  fluid.connect(model);
  const DofMap<D> dofs(fluid.particles);
  RigidResistance<D> resistance(fluid.box);
  resistance.rebuild(fluid.network, dofs, fluid.particles, fluid.particles.position, arms, shift);
  const System& system = resistance.system();
  const auto motions = system.null_motions();
  for (std::size_t k = 0; k < motions.size(); ++k) {
    std::vector<double> cost(motions[k].size()), kept = motions[k];
    EXPECT_EQ(static_cast<std::int64_t>(kept.size()), system.size());
    system.apply(motions[k], cost);
    EXPECT_LT(support::norm(cost), 1e-12) << "motion " << k;
    if (system.translations_are_null()) {
      system.translations().remove_mean(kept);
      for (std::size_t i = 0; i < kept.size(); ++i) EXPECT_NEAR(kept[i], motions[k][i], 1e-13);
    }
    for (std::size_t l = 0; l <= k; ++l)
      EXPECT_NEAR(support::dot(motions[k], motions[l]), k == l ? 1.0 : 0.0, 1e-12);
    system.project(kept);
    EXPECT_LT(support::norm(kept), 1e-12) << "nothing of it is left by the projection";
  }
  return motions.size();
}

template <int D>
std::size_t count(Fluid<D>& fluid, const DpdParameters& p = {}, double shift = 0.0,
                  std::span<const Vec<D>> arms = {}) {
  return count<D>(fluid, DpdModel<D>(1, {p}), shift, arms);
}

template <int D>
constexpr std::size_t rotations = static_cast<std::size_t>(rotation_components<D>);

TYPED_TEST(FreeMotionsTest, ADropTurnsWhereverItLies) {
  constexpr int D = TypeParam::D;
  for (const double middle : {3.0, 0.0}) {  // in the box, and across all of its faces
    Drop<D> fluid(middle);
    EXPECT_EQ(count<D>(fluid), rotations<D>);
    EXPECT_EQ(count<D>(fluid, {}, 1e-3), 0U) << "mass or drag holds it";
    DpdParameters across;
    across.gamma_perp = 0.5;
    EXPECT_EQ(count<D>(fluid, across), 0U) << "friction across the links resists";
  }
}

TYPED_TEST(FreeMotionsTest, AFluidThatFillsItsBoxDoesNot) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid{5.0, true};
  add_points<D>(fluid, {}, fluid.box.size, D == 2 ? 150 : 600);
  EXPECT_EQ(count<D>(fluid), 0U);
}

// Bent, so that no path along its links goes straight round the box: found from all links.
TEST(FreeMotions, AStripAroundTheBoxDoesNotTurn) {
  Fluid<2> fluid{edge_of_box, true};
  for (int k = 0; k < 60; ++k)
    for (const double aside : {0.0, 0.3}) {
      const double x = 0.1 * k;
      Vec<2> r{{x, 3.0 + 1.2 * std::sin(2.0 * M_PI * x / edge_of_box) + aside}};
      fluid.particles.add(r, 0);
    }
  EXPECT_EQ(count<2>(fluid), 0U);
}

// A thread through a periodic box turns about itself and no other way; crossed threads do not turn.
TEST(FreeMotions, AThreadTurnsAboutItself) {
  Fluid<3> fluid{edge_of_box, true};
  add_points<3>(fluid, {{2.5, 2.5, 0.0}}, {{3.5, 3.5, edge_of_box}}, 80);
  ASSERT_EQ(count<3>(fluid), 1U);
  const DofMap<3> dofs(fluid.particles);
  Resistance<3> resistance(fluid.box);
  resistance.rebuild(fluid.network, dofs, fluid.particles, fluid.particles.position, 0.0);
  const auto& u = resistance.null_motions()[0];
  for (std::size_t n = 0; n < u.size() / 3; ++n) EXPECT_NEAR(u[3 * n + 2], 0.0, 1e-12);
  add_points<3>(fluid, {{0.0, 2.5, 2.5}}, {{edge_of_box, 3.5, 3.5}}, 80);
  EXPECT_EQ(count<3>(fluid), 0U);
}

// Of d(d+1)/2 rigid motions a known particle in its midst leaves the rotations about it, a second one those about the line
// through both, a third one none.
TYPED_TEST(FreeMotionsTest, KnownParticlesTakeThemAway) {
  constexpr int D = TypeParam::D;
  const std::size_t left[] = {D == 2 ? 1 : 3, D == 2 ? 0 : 1, 0};
  for (const double middle : {3.0, 0.0}) {
    Drop<D> fluid(middle);
    for (int known = 0; known < 3; ++known) {
      auto r = support::uniform_vec<D>(middle);
      r[0] += known == 1 ? 0.4 : 0.0;
      r[1] += known == 2 ? -0.4 : 0.0;
      fluid.box.wrap(r);
      fluid.particles.add(r, 0, odpd::Group::wall(0));
      EXPECT_EQ(count<D>(fluid), left[known]) << known + 1 << " known, middle " << middle;
    }
  }
}

TYPED_TEST(FreeMotionsTest, WallsHoldAFluidInAnOpenBox) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid{4.0, false, D == 2 ? 100U : 400U, 3, 1.0};
  EXPECT_EQ(count<D>(fluid), 0U);
}

// Free bodies in the drop move with it: V of their centres and w.
TYPED_TEST(FreeMotionsTest, BodiesTurnWithTheirDrop) {
  constexpr int D = TypeParam::D;
  Drop<D> fluid(0.0);
  std::vector<Vec<D>> arms(fluid.particles.position.size());
  RigidBody<D> body;
  for (int corner = 0; corner <= D; ++corner) {
    body.frame.push_back(support::uniform_vec<D>(corner == 0 ? -0.4 : 0.0));
    if (corner > 0) body.frame.back()[corner - 1] += 0.4;
    arms.push_back(body.frame.back());
  }
  fluid.particles.add_body(body, fluid.box, 0);
  EXPECT_EQ(count<D>(fluid, {}, 0.0, arms), rotations<D>);
}

// Friction in all directions along one link leaves the rotation about it.
TYPED_TEST(FreeMotionsTest, OneLinkIsAnAxis) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid{edge_of_box, true};
  RigidBody<D> body;
  body.pose.centre = support::uniform_vec<D>(3.0);
  for (int corner = 0; corner <= D; ++corner) {
    body.frame.push_back(support::uniform_vec<D>(corner == 0 ? -0.5 : 0.0));
    if (corner > 0) body.frame.back()[corner - 1] += 0.5;
  }
  std::vector<Vec<D>> arms(body.frame);
  fluid.particles.add_body(body, fluid.box, 0);
  arms.emplace_back();
  fluid.particles.add(support::uniform_vec<D>(2.0), 0);  // the first corner is within its reach
  DpdParameters across;
  across.gamma_perp = 0.5;
  EXPECT_EQ(count<D>(fluid, across, 0.0, arms), D == 2 ? 0U : 1U);
  ASSERT_EQ(fluid.network.size(), 1);
}

// A drop that friction across its links keeps from turning slides across the one link that holds it.
TYPED_TEST(FreeMotionsTest, FrictionInsideADropDoesNotHoldIt) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid{edge_of_box, true};
  for (int corner = 0; corner <= D; ++corner) {
    auto r = support::uniform_vec<D>(3.0);
    if (corner > 0) r[corner - 1] += 0.6;
    fluid.particles.add(r, 0);
  }
  fluid.particles.add(support::uniform_vec<D>(2.6), 1, Group::wall(0));
  DpdParameters across, along;
  across.gamma_perp = 0.5;
  EXPECT_EQ(count<D>(fluid, DpdModel<D>(2, {across, along, along, along})),
            static_cast<std::size_t>(D - 1));
  EXPECT_EQ(count<D>(fluid, DpdModel<D>(2, {across, across, across, along})), 0U);
}

// As many pinned clusters as there may be, and one more.
TYPED_TEST(FreeMotionsTest, TooManyAreRefused) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid{30.0, true};
  const auto add_pinned = [&](std::size_t k) {
    auto middle = support::uniform_vec<D>(1.5);
    middle[0] += 3.0 * static_cast<double>(k % 8);
    middle[1] += 3.0 * static_cast<double>(k / 8);
    fluid.particles.add(middle, 0, Group::wall(0));
    for (int corner = 0; corner <= D; ++corner) {
      Vec<D> r = middle + support::uniform_vec<D>(-0.2);
      if (corner > 0) r[corner - 1] += 0.6;
      fluid.particles.add(r, 0);
    }
  };
  const std::size_t most = static_cast<std::size_t>(most_free_motions) / rotations<D>;
  for (std::size_t k = 0; k < most; ++k) add_pinned(k);
  EXPECT_EQ(count<D>(fluid), most * rotations<D>);
  add_pinned(most);
  try {
    count<D>(fluid);
    ADD_FAILURE() << "not refused";
  } catch (const SolverError& error) {
    EXPECT_EQ(error.cause(), SolverError::Cause::singular);
    const std::string message = error.what();
    for (const std::string& part :
         {std::to_string(most + 1) + " groups of particles, one with particle 1,",
          std::to_string((most + 1) * rotations<D>) + " null motions", std::string("fluid.zeta_0"),
          std::string("fluid.mass"), std::string("fluid.gamma_perp")})
      EXPECT_NE(message.find(part), std::string::npos) << part << " in " << message;
  }
}

}  // namespace
