#include <gtest/gtest.h>

#include "cases.h"
#include "odpd/pairs/bonds.h"
#include "odpd/scene/scene.h"
#include "support/errors.h"

namespace {

using odpd::Scene;
using odpd::Vec;

const char* const colloids = R"(
[[species]]
name = "fluid"
[[species]]
name = "bead"
count = 0
[[molecule]]
name = "colloid"
shape = "simplex"
spacing = 0.25
species = "bead"
H = 1000.0
count = 7
[[molecule]]
name = "chain"
shape = "walk"
spacing = 0.5
beads = 9
species = "bead"
law = "fene"
H = 30.0
r_max = 1.5
count = 3
)";

template <int D>
Vec<D> unwrapped(const Scene<D>& scene, std::int64_t id) {
  const auto& p = scene.particles();
  const auto i = static_cast<std::size_t>(p.index_of_id()[static_cast<std::size_t>(id)]);
  Vec<D> r = p.position[i];
  for (std::size_t c = 0; c < D; ++c) r.x[c] += p.image[i][c] * scene.box().size.x[c];
  return r;
}

template <int D>
void expect_molecules(const Scene<D>& scene, std::int64_t fluid) {
  const std::int64_t beads = 7 * (D + 1) + 27, bonds = 7 * D * (D + 1) / 2 + 24;
  EXPECT_EQ(scene.particles().free_count(), fluid + beads);
  ASSERT_EQ(static_cast<std::int64_t>(scene.bonds().size()), bonds);
  ASSERT_EQ(scene.molecules().size(), 10u);
  std::int64_t of_species = 0;
  for (const auto s : scene.particles().species) of_species += s;
  EXPECT_EQ(of_species, beads);
  EXPECT_EQ(scene.molecules().back().first + 9, scene.particles().size());
  double most = 0.0;
  for (const odpd::Bond& bond : scene.bonds()) {
    const double r = norm(unwrapped(scene, bond.i) - unwrapped(scene, bond.j));
    most = std::max(most, r);
    if (bond.p.law == odpd::BondLaw::harmonic) {
      EXPECT_NEAR(r, 0.25, 0.05);
    }
  }
  EXPECT_LT(most, 1.0);
  EXPECT_GT(most, 0.3);
}

TEST(Molecules, LieBetweenTheWallsWithTheirBondsRelaxed) {
  const Scene<2> scene(cases::settings<2>(std::string(cases::channel) + colloids));
  expect_molecules(scene, 400);
  for (const auto& m : scene.molecules()) {
    const double y = unwrapped(scene, m.first)[1];
    EXPECT_TRUE(y > 0.8 && y < 11.2) << y;
  }
  // Its model is that of the pairs with the bonds behind.
  EXPECT_NE(dynamic_cast<const odpd::BondedModel<2>*>(&scene.model()), nullptr);
}

TEST(Molecules, AreTetrahedraAndChainsIn3D) {
  expect_molecules(Scene<3>(cases::settings<3>(std::string(cases::periodic) + colloids)), 180);
}

TEST(Molecules, OnSitesStartWithoutForce) {
  auto settings = cases::settings<3>(std::string(cases::periodic) + colloids + R"(
[[molecule]]
name = "tied"
shape = "points"
points = [{ at = [0.0, 0.0, 0.0] }, { at = [0.3, 0.0, 0.0] }, { at = [0.0, 0.4, 0.0] }, { at = [0.1, 0.1, 0.3] }]
species = "bead"
bonds = "sites"
H = 1000.0
count = 3
)");
  settings.relax_sweeps = 0;
  const Scene<3> scene(settings);
  const auto& p = scene.particles();
  odpd::PairList<3> list(scene.box(), scene.model().cutoff());
  list.update(p.position);
  odpd::PairNetwork<3> network;
  scene.model().write_edges(list, scene.box(), p.position, p, network);
  ASSERT_EQ(network.bonds, 7 * 6 + 24 + 18);
  ASSERT_EQ(network.beyond.size(), 84u);
  for (std::size_t k = network.i.size() - 18; k < network.i.size(); ++k) {
    EXPECT_LT(network.u[k], 1e-20);
    EXPECT_EQ(network.k_c[k], 1000.0 / 4.0);
  }
}

// What a run wrote starts the same molecules; then the file's order is theirs.
TEST(Molecules, AreTheLastOfAStartFile) {
  const auto text = std::string(cases::periodic) + colloids;
  const Scene<3> first(cases::settings<3>(text));
  auto settings = cases::settings<3>(text, {"start.from=file", "start.file=unused.csv"});
  for (std::int64_t id = 0; id < first.particles().size(); ++id) {
    Vec<3> r = unwrapped(first, id);
    settings.box.wrap(r);
    settings.start_positions.push_back(r);
    settings.start_species.push_back(first.particles().species[static_cast<std::size_t>(
        first.particles().index_of_id()[static_cast<std::size_t>(id)])]);
  }
  const Scene<3> again(settings);
  expect_molecules(again, 180);
  EXPECT_NEAR(
      norm(again.box().separation(again.particles().position[190], settings.start_positions[190])),
      0.0, 1e-12);
  auto without_species = settings;
  without_species.start_species.clear();
  expect_molecules(Scene<3>(without_species), 180);
  auto wrong = settings;
  std::swap(wrong.start_species[0], wrong.start_species[200]);
  support::expect_error<odpd::ConfigError>([&] { Scene<3>{wrong}; },
                                           {"unused.csv", "particle 200", "'fluid'", "'bead'"});
  auto few = settings;
  few.start_positions.resize(20);
  few.start_species.resize(20);
  support::expect_error<odpd::ConfigError>([&] { Scene<3>{few}; },
                                           {"holds 20", "of the molecules"});
}

// The third way to a colloid: one particle with a cutoff of its own beyond the fluid's.
TEST(Molecules, ALargerParticleNeedsNone) {
  const Scene<2> scene(cases::settings<2>(std::string(cases::channel) + R"(
[[species]]
name = "fluid"
[[species]]
name = "colloid"
count = 1
[[pair]]
species = ["fluid", "colloid"]
cutoff = 1.5
a = 60.0
)"));
  EXPECT_EQ(scene.model().cutoff(), 1.5);
  EXPECT_GT(scene.model().pair(1.2, {0}, {1}).f_c, 0.0);
  EXPECT_EQ(scene.model().pair(1.2, {0}, {0}).f_c, 0.0);
  EXPECT_EQ(scene.model().pair(1.2, {1}, {1}).f_c, 0.0);
  // Relaxed, nothing comes closer to it than fluid particles do to each other.
  const auto& p = scene.particles();
  std::size_t colloid = 0;
  for (std::size_t i = 0; i < p.position.size(); ++i)
    if (p.species[i] == 1) colloid = i;
  double nearest = 9.0;
  for (std::size_t i = 0; i < p.position.size(); ++i)
    if (i != colloid && p.is_free(i))
      nearest = std::min(nearest, norm(scene.box().separation(p.position[i], p.position[colloid])));
  EXPECT_GT(nearest, 0.6);
}

}  // namespace
