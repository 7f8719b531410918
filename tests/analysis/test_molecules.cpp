// The observer of molecules: the solvent around their centres.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/analysis/molecules.h"
#include "records.h"
#include "support/dimensions.h"

namespace {

template <class T>
class MoleculesObserverTest : public ::testing::Test {};
TYPED_TEST_SUITE(MoleculesObserverTest, support::Dimensions);

template <int D>
odpd::MoleculeSettings<D> crossed(const std::string& name, double arm) {
  odpd::MoleculeSettings<D> m;
  m.name = name;
  for (int c = 0; c < D; ++c)
    for (const double end : {arm, -arm}) {
      m.shape.emplace_back();
      m.shape.back()[c] = end;
    }
  for (std::int64_t k = 1; k < m.beads(); ++k)
    m.bonds.push_back({k - 1, k, {.H = 1.0, .r_0 = arm}});
  m.species.assign(m.shape.size(), 0);
  return m;
}

/// Solvent, then thirty molecules of two kinds about `centres`, their beads in the box.
template <int D>
odpd::SceneSettings<D> suspension(odpd::Vec<D> size, std::vector<odpd::Vec<D>> solvent,
                                  const std::vector<odpd::Vec<D>>& centres) {
  std::vector<odpd::MoleculeSettings<D>> molecules{crossed<D>("a", 0.2), crossed<D>("b", 0.1)};
  odpd::SceneSettings<D> s = records::periodic<D>(1.0, {});
  s.box.size = size;
  for (std::size_t k = 0; k < centres.size(); ++k)
    for (const odpd::Vec<D>& arm : molecules[k < centres.size() / 2 ? 0 : 1].shape) {
      solvent.push_back(centres[k] + arm);
      s.box.wrap(solvent.back());
    }
  s.start_positions = solvent;
  for (auto& m : molecules) m.count = static_cast<std::int64_t>(centres.size()) / 2;
  s.molecules = molecules;
  return s;
}

// g(q) from all pairs of a centre and a particle of the solvent, with sliding images and without; many molecules lie across
// borders. Beads are no solvent.
TYPED_TEST(MoleculesObserverTest, SolventAroundCentresIsCountedWithoutMissingAny) {
  constexpr int D = TypeParam::D;
  constexpr double r_max = 0.9, bin = 0.1;
  constexpr std::size_t fluid = 2000, count = 30;
  odpd::Vec<D> size = support::uniform_vec<D>(4.0);
  size[0] = 8.0;
  const auto centres = support::random_points<D>(odpd::Vec<D>{}, size, count, 2);
  const odpd::Scene<D> scene(
      suspension<D>(size, support::random_points<D>(odpd::Vec<D>{}, size, fluid, 1), centres));
  for (const double offset : {0.0, 2.8, -4.0}) {
    odpd::StepRecord<D> record = records::record<D>(scene);
    odpd::Box<D>& box = record.start.box;
    if (offset != 0.0) {
      box.shear = odpd::Shear{};
      box.offset = offset;
      const odpd::MoleculeSettings<D>* kind = scene.settings().molecules.data();
      std::size_t next = fluid;
      for (std::size_t k = 0; k < count; ++k)
        for (const odpd::Vec<D>& arm : kind[2 * k / count].shape) {
          record.start.position[next] = centres[k] + arm;
          box.wrap(record.start.position[next++]);
        }
    }
    odpd::MoleculeStatistics<D> molecules({.kind = "molecules", .name = "m"},
                                          {.msd = {}, .around = {.r_max = r_max, .bin = bin}},
                                          scene, 0.01, false);
    molecules.measure(odpd::Clock{}, scene.particles(), record);
    std::vector<std::vector<double>> counted(2, std::vector<double>(9, 0.0));
    for (std::size_t k = 0; k < count; ++k)
      for (std::size_t i = 0; i < fluid; ++i) {
        const double q = norm(box.separation(record.start.position[i], centres[k]));
        if (q < r_max) counted[2 * k / count][static_cast<std::size_t>(q / bin)] += 1.0;
      }
    const odpd::Results results = records::results(molecules);
    const odpd::Table& table = results.tables.at(0).second;
    EXPECT_EQ(table.columns,
              (std::vector<std::string>{"q", "g_a", "g_a_error", "g_b", "g_b_error"}));
    ASSERT_EQ(table.rows.size(), 9u);
    for (std::size_t kind : {0, 1})
      for (std::size_t k = 0; k < 9; ++k) {
        const double inner = bin * static_cast<double>(k), outer = inner + bin;
        const double shell = odpd::unit_ball_volume<D> * (std::pow(outer, D) - std::pow(inner, D));
        EXPECT_NEAR(table.rows[k][1 + 2 * kind],
                    counted[kind][k] / 15.0 * scene.box().volume() / 2000.0 / shell, 1e-11)
            << offset << " " << k;
      }
    EXPECT_GT(counted[0][8] + counted[1][8], 10.0);
  }
}

// The solvent keeps 0.6 from the centres of one kind and none from the others.
TYPED_TEST(MoleculesObserverTest, ExclusionRadiusIsThatOfTheHole) {
  constexpr int D = TypeParam::D;
  const odpd::Vec<D> size = support::uniform_vec<D>(6.0);
  std::vector<odpd::Vec<D>> centres;
  for (std::size_t k = 0; k < 4; ++k) {
    centres.push_back(support::uniform_vec<D>(0.1));
    centres.back()[0] += 1.5 * static_cast<double>(k);
  }
  auto solvent = support::random_points<D>(odpd::Vec<D>{}, size, 4000, 3);
  const odpd::Box<D> box = records::periodic<D>(6.0, {}).box;
  std::erase_if(solvent, [&](const odpd::Vec<D>& r) {
    return norm(box.separation(r, centres[0])) < 0.6 || norm(box.separation(r, centres[1])) < 0.6;
  });
  const odpd::Scene<D> scene(suspension<D>(size, solvent, centres));
  odpd::MoleculeStatistics<D> molecules({.kind = "molecules", .name = "m"},
                                        {.msd = {}, .around = {.r_max = 1.5}}, scene, 0.01, false);
  molecules.measure(odpd::Clock{}, scene.particles(), records::record(scene));
  const odpd::Results results = records::results(molecules);
  EXPECT_NEAR(records::mean(results, "m.a.exclusion_radius"), 0.6, 0.02);
  EXPECT_LT(records::mean(results, "m.b.exclusion_radius"), 0.4);
}

// A melt has no solvent.
TEST(MoleculesObserver, KnowsNoSolventInAMelt) {
  const odpd::Vec<2> size = support::uniform_vec<2>(4.0);
  const odpd::Scene<2> scene(
      suspension<2>(size, {}, support::random_points<2>(odpd::Vec<2>{}, size, 10, 4)));
  odpd::MoleculeStatistics<2> molecules({.kind = "molecules", .name = "m"},
                                        {.msd = {}, .around = {}}, scene, 0.01, false);
  molecules.measure(odpd::Clock{}, scene.particles(), records::record(scene));
  const odpd::Results results = records::results(molecules);
  EXPECT_EQ(results.find("m.a.exclusion_radius"), nullptr);
  EXPECT_TRUE(results.tables.empty());
  EXPECT_TRUE(results.charts.empty());
}

}  // namespace
