#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

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

// Nguyen 2021, table 5.1: octahedra of six, 3^3 to 13^3 of them, beside 13500 particles of the solvent in a cube of 15, as a
// case has them. Its volume fraction is a fraction of particles; the distances are (5.4) and (5.3).
TEST(Molecules, ThesisTable51) {
  const struct {
    double phi, sphere, cube;
  } rows[] = {{0.0119, 3.1018, 5.0000}, {0.0277, 2.3263, 3.7500}, {0.0526, 1.8611, 3.0000},
              {0.0876, 1.5509, 2.5000}, {0.1323, 1.3293, 2.1429}, {0.1854, 1.1632, 1.8750},
              {0.2447, 1.0339, 1.6667}, {0.3077, 0.9305, 1.5000}, {0.3717, 0.8459, 1.3636},
              {0.4344, 0.7754, 1.2500}, {0.4940, 0.7158, 1.1538}};
  std::int64_t edge = 3;
  for (const auto& row : rows) {
    const auto s = cases::settings<3>(R"(
[box]
size = [15.0, 15.0, 15.0]
periodic = [true, true, true]
[fluid]
density = 4.0
mass = 1.0
kT = 1.0
cutoff = 1.5
a = 3.53
gamma = 6.97
s = 0.42
[[molecule]]
name = "octahedron"
shape = "octahedron"
radius = 0.2
species = "fluid"
bonds = "sites"
H = 1000.0
count = )" + std::to_string(edge * edge * edge));
    ++edge;
    const double solvent = s.density * s.fluid_volume();
    const auto beads = static_cast<double>(s.molecule_beads());
    const double volume = s.fluid_volume() / static_cast<double>(s.molecules[0].molecules());
    EXPECT_NEAR(beads / (beads + solvent), row.phi, 5e-5);
    EXPECT_NEAR(std::cbrt(3.0 * volume / (4.0 * std::numbers::pi)), row.sphere, 5e-5);
    EXPECT_NEAR(std::cbrt(volume), row.cube, 5e-5);
  }
}

// Beads at one distance from the centre and, of a shape given by its spacing, each with as many neighbours there as the
// shape has.
template <int D>
void expect_corners(const std::string& shape, std::int64_t beads, std::int64_t neighbours,
                    double radius_of_edge) {
  for (const bool by_radius : {true, false}) {
    const auto s = cases::settings<D>(std::string(D == 2 ? cases::channel : cases::periodic) + R"(
[[species]]
name = "fluid"
[[molecule]]
species = "fluid"
H = 100.0
shape = ")" + shape + (by_radius ? "\"\nradius = 0.2" : "\"\nspacing = 0.2"));
    const odpd::MoleculeSettings<D>& m = s.molecules.at(0);
    const double radius = by_radius ? 0.2 : 0.2 * radius_of_edge, edge = radius / radius_of_edge;
    ASSERT_EQ(m.beads(), beads);
    EXPECT_EQ(std::ssize(m.bonds), beads * (beads - 1) / 2);
    for (const Vec<D>& a : m.shape) {
      EXPECT_NEAR(norm(a), radius, 1e-14) << shape;
      std::int64_t near = 0;
      for (const Vec<D>& b : m.shape) {
        EXPECT_TRUE(&a == &b || norm(a - b) > edge - 1e-14) << shape;
        if (std::abs(norm(a - b) - edge) < 1e-14) ++near;
      }
      EXPECT_EQ(near, neighbours) << shape;
    }
  }
}

// Colloids of one particle: apart from each other, and the fluid relaxed out of their cores.
TEST(Molecules, OfOneParticleKeepTheirClearance) {
  const std::string text = std::string(cases::periodic) + R"(
[[species]]
name = "fluid"
[[species]]
name = "colloid"
count = 0
[[pair]]
species = ["fluid", "colloid"]
a = 60.0
core = 0.6
cutoff = 1.1
[[molecule]]
name = "ball"
shape = "particle"
species = "colloid"
count = 5
clearance = 1.7
hydrodynamic_radius = 0.7
excluded_volume = 1.5
)";
  const auto s = cases::settings<3>(text);
  EXPECT_EQ(s.molecules.at(0).excluded_volume, 1.5);
  EXPECT_EQ(s.molecules.at(0).hydrodynamic_radius, 0.7);
  const Scene<3> scene(s), as_placed(cases::settings<3>(text, {"start.relax_sweeps=0"}));
  const auto& p = scene.particles();
  EXPECT_EQ(p.free_count(), 180 + 5);
  std::int64_t inside = 0;
  double nearest = 100.0;
  for (std::size_t i = 0; i < p.position.size(); ++i) {
    if (p.species[i] != 1) continue;
    for (std::size_t j = 0; j < p.position.size(); ++j) {
      const auto& q = as_placed.particles().position;
      if (p.species[j] == 1 && i != j)
        nearest = std::min(nearest, norm(scene.box().separation(q[i], q[j])));
      if (p.species[j] == 0 && norm(scene.box().separation(p.position[i], p.position[j])) < 0.6)
        ++inside;
    }
  }
  EXPECT_EQ(inside, 0);
  EXPECT_GE(nearest, 1.7);
  support::expect_error<odpd::ConfigError>(
      [&] { Scene<3>(cases::settings<3>(text, {"molecule.0.clearance=2.6"})); },
      {"[[molecule]] 'ball'", "5 molecules", "clearance"});
  support::expect_error<odpd::ConfigError>(
      [&] { cases::settings<3>(text, {"molecule.0.excluded_volume=15.0"}); },
      {"excluded_volume", "75 of the 60"});
  support::expect_error<odpd::ConfigError>([&] { cases::settings<3>(text, {"pair.0.core=1.1"}); },
                                           {"core", "smaller than the cutoff of the pair, 1.1"});
}

TEST(Molecules, HaveCornersBySpacingOrRadius) {
  expect_corners<2>("simplex", 3, 2, 1.0 / std::sqrt(3.0));
  expect_corners<3>("simplex", 4, 3, std::sqrt(3.0 / 8.0));
  expect_corners<3>("octahedron", 6, 4, std::sqrt(0.5));
  expect_corners<3>("cube", 8, 3, std::sqrt(0.75));
}

}  // namespace
