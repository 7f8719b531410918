#include <gtest/gtest.h>

#include "odpd/operator/spin_resistance.h"
#include "odpd/pairs/levers.h"
#include "support/dimensions.h"
#include "support/errors.h"
#include "support/network.h"

namespace {

using odpd::DofMap;
using odpd::DpdModel;
using odpd::DpdParameters;
using odpd::Resistance;
using odpd::Vec;
using support::Fluid;

// A dense drop held by known particles, and the particles of interest far from it.
template <int D>
struct Lonely {
  Fluid<D> fluid{12.0, true};

  Lonely() {
    const auto drop = support::random_points<D>(support::uniform_vec<D>(1.0),
                                                support::uniform_vec<D>(2.5), D == 2 ? 25 : 60, 1);
    for (const auto& r : drop) fluid.particles.add(r, 0);
    fluid.particles.add(support::uniform_vec<D>(1.75), 0, odpd::Group::wall(0));
  }
  /// A particle at (8, 8, 8) + offset; known ones do not need neighbours.
  std::int64_t add(const Vec<D>& offset, bool known = false) {
    fluid.particles.add(support::uniform_vec<D>(8.0) + offset, 0,
                        known ? odpd::Group::wall(0) : odpd::Group());
    return fluid.particles.id.back();
  }
  void rebuild(const DpdParameters& p, double shift) {
    fluid.connect(DpdModel<D>(1, {p}));
    Resistance<D> resistance(fluid.box);
    resistance.rebuild(fluid.network, DofMap<D>(fluid.particles), fluid.particles,
                       fluid.particles.position, shift);
  }
  /// Where all spin, with friction across; `inertia`: 2 m/dt with m = 1 and this moment of inertia.
  void rebuild_spins(double inertia, double moment) {
    fluid.particles.spin_of_species = {{.lever_radius = 0.4, .moment = moment}};
    DpdParameters p;
    p.gamma_perp = 2.0;
    fluid.connect(DpdModel<D>(1, {p}));
    odpd::write_levers(fluid.particles, fluid.network);
    odpd::SpinResistance<D> resistance(fluid.box);
    const DofMap<D> dofs(fluid.particles, 1.0);
    resistance.rebuild(fluid.network, dofs, fluid.particles, fluid.particles.position, {},
                       {.inertia = inertia});
  }
  /// The error names this particle, its neighbours and what helps; mass and a far friction cure it.
  void expect_rattler(std::int64_t id, int neighbours) {
    const std::string who = "particle " + std::to_string(id) + " is a rattler";
    const std::string how_many = std::to_string(neighbours) + " neighbour";
    support::expect_error<odpd::SolverError>(
        [&] { rebuild(DpdParameters{}, 0.0); },
        {who.c_str(), how_many.c_str(), "rattler_friction", "density", "cutoff"});
    EXPECT_NO_THROW(rebuild(DpdParameters{}, 1e-3)) << "a shift holds it";
  }
};

template <int D>
Vec<D> along(int c, double x) {
  Vec<D> v{};
  v[c] = x;
  return v;
}

DpdParameters far_friction() {
  DpdParameters p;
  p.gamma_far = 0.1;
  p.cutoff_far = 2.0;
  return p;
}

template <class T>
class RattlerTest : public ::testing::Test {};
TYPED_TEST_SUITE(RattlerTest, support::Dimensions);

TYPED_TEST(RattlerTest, WithoutNeighbours) {
  Lonely<TypeParam::D> scene;
  EXPECT_NO_THROW(scene.rebuild(DpdParameters{}, 0.0)) << "the drop alone is sound";
  scene.expect_rattler(scene.add({}), 0);
}

TYPED_TEST(RattlerTest, WithOneNeighbour) {
  constexpr int D = TypeParam::D;
  Lonely<D> scene;
  const auto id = scene.add({});
  scene.add(along<D>(0, 0.5) + along<D>(1, 0.2), true);
  scene.expect_rattler(id, 1);
}

TYPED_TEST(RattlerTest, WithCollinearNeighbours) {
  constexpr int D = TypeParam::D;
  const Vec<D> direction = along<D>(0, 0.3) + along<D>(D - 1, 0.37);
  Lonely<D> scene;
  const auto id = scene.add({});
  for (const double side : {-1.0, 0.7, 1.0}) scene.add(side * direction, true);
  scene.expect_rattler(id, 3);
}

TEST(Rattler, WithCoplanarNeighboursInThreeDimensions) {
  Lonely<3> scene;
  const auto id = scene.add({});
  const Vec<3> a{{0.5, 0.2, 0.1}}, b{{-0.1, 0.6, 0.3}};
  for (const Vec<3>& offset : {a, b, 0.5 * (a + b), -0.9 * a}) scene.add(offset, true);
  scene.expect_rattler(id, 4);
  scene.add({{0.0, 0.0, 0.7}}, true);
  EXPECT_NO_THROW(scene.rebuild(DpdParameters{}, 0.0)) << "one out of the plane holds it";
}

TYPED_TEST(RattlerTest, IsNamedByIdentityAfterReordering) {
  constexpr int D = TypeParam::D;
  Lonely<D> scene;
  const auto id = scene.add({});
  const auto n = static_cast<std::size_t>(scene.fluid.particles.size());
  scene.fluid.particles.reorder(support::random_order(n, 3));
  scene.expect_rattler(id, 0);
}

TYPED_TEST(RattlerTest, FarFrictionIsACure) {
  constexpr int D = TypeParam::D;
  Lonely<D> scene;
  scene.add({});
  for (int c = 0; c < D; ++c) scene.add(along<D>(c, 1.5), true);  // out of the reach of gamma
  EXPECT_THROW(scene.rebuild(DpdParameters{}, 0.0), odpd::SolverError);
  EXPECT_NO_THROW(scene.rebuild(far_friction(), 0.0));
}

TYPED_TEST(RattlerTest, TransverseFrictionIsACure) {
  constexpr int D = TypeParam::D;
  Lonely<D> scene;
  scene.add({});
  scene.add(along<D>(0, 0.5), true);
  EXPECT_THROW(scene.rebuild(DpdParameters{}, 0.0), odpd::SolverError);
  DpdParameters p;
  p.gamma_perp = 0.5;
  EXPECT_NO_THROW(scene.rebuild(p, 0.0));
}

// Held by one neighbour, its blocks of velocity and of spin are regular, but it can roll along it; in 3D along two as well.
TYPED_TEST(RattlerTest, SpinsRollAlongFewNeighbours) {
  constexpr int D = TypeParam::D;
  Lonely<D> scene;
  EXPECT_NO_THROW(scene.rebuild_spins(0.0, 0.0)) << "the drop alone is sound";
  const std::int64_t id = scene.add({});
  const std::string who = "particle " + std::to_string(id) + " can spin, or roll";
  for (int neighbours = 1; neighbours < D; ++neighbours) {
    scene.add(along<D>(neighbours - 1, 0.5), true);
    const std::string how_many = std::to_string(neighbours) + ", resist";
    support::expect_error<odpd::SolverError>(
        [&] { scene.rebuild_spins(0.0, 0.0); },
        {who.c_str(), how_many.c_str(), "moment", "density", "cutoff"});
    EXPECT_NO_THROW(scene.rebuild_spins(1e-2, 0.1)) << "inertia of both";
  }
  scene.add(along<D>(D - 1, 0.5), true);
  EXPECT_NO_THROW(scene.rebuild_spins(0.0, 0.0)) << "neighbours on all sides";
}

// By one contact with what is held a cluster rolls about that point: it does not turn about the particle there, as it would without
// spins.
TYPED_TEST(RattlerTest, AClusterRollsAboutOneContact) {
  constexpr int D = TypeParam::D;
  Fluid<D> fluid{12.0, true};
  const auto centre = support::uniform_vec<D>(6.0);
  fluid.particles.add(centre, 0);
  for (int c = 1; c < D; ++c)
    for (const double side : {-0.3, 0.3})
      fluid.particles.add(centre + along<D>(0, -0.5) + along<D>(c, side), 0);
  fluid.particles.spin_of_species = {{.lever_radius = 0.4}};
  const auto rebuild = [&] {
    DpdParameters p;
    p.gamma_perp = 2.0;
    fluid.connect(DpdModel<D>(1, {p}));
    odpd::write_levers(fluid.particles, fluid.network);
    odpd::SpinResistance<D> resistance(fluid.box);
    const DofMap<D> dofs(fluid.particles);
    resistance.rebuild(fluid.network, dofs, fluid.particles, fluid.particles.position, {}, {});
    return std::ssize(resistance.null_motions());
  };
  EXPECT_EQ(rebuild(), D == 2 ? 1 : 3) << "it floats: rotations";
  fluid.particles.add(centre + along<D>(0, 0.9), 0, odpd::Group::wall(0));
  support::expect_error<odpd::SolverError>([&] { rebuild(); }, {"may roll", "mass"});
}

}  // namespace
