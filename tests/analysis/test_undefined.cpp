// What nobody is there to be measured of is undefined and a note says so: it does not read 0.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "odpd/analysis/block_average.h"
#include "odpd/analysis/msd.h"
#include "odpd/analysis/rdf.h"
#include "records.h"

namespace {

using odpd::Clock;
using odpd::Results;
using odpd::Scene;
using odpd::Vec;

/// Species a of 30 particles, b of one, c of none.
Scene<2> three_species() {
  auto s = records::periodic<2>(
      4.0, support::random_points<2>(Vec<2>{}, support::uniform_vec<2>(4.0), 31, 3));
  s.species = {{.name = "a", .fraction = 1.0}, {.name = "b"}, {.name = "c"}};
  s.start_species.assign(31, 0);
  s.start_species.back() = 1;
  s.model = odpd::make_dpd<2>({}, 3);
  return Scene<2>(s);
}

bool noted(const Results& results, const std::string& text) {
  return std::any_of(results.notes.begin(), results.notes.end(),
                     [&](const std::string& note) { return note.find(text) != std::string::npos; });
}

TEST(Undefined, PairsOfAnEmptySpecies) {
  const Scene<2> scene = three_species();
  odpd::Rdf<2> rdf({.kind = "rdf", .name = "g"},
                   {.r_max = 2.0,
                    .bins = 10,
                    .comparison = odpd::RdfComparison{.value = 1.0, .from = 0.0, .to = 2.0}},
                   scene);
  EXPECT_TRUE(std::isnan(records::mean(records::results(rdf), "g.rms_deviation"))) << "nothing yet";
  for (int k = 0; k < 40; ++k) rdf.measure(Clock{}, scene.particles(), records::record(scene));
  const Results results = records::results(rdf);
  const odpd::Table& table = results.tables.at(0).second;
  for (std::size_t column = 1; column < table.columns.size(); ++column) {
    const std::string& name = table.columns[column];
    const bool defined = name.starts_with("g_a_a") || name.starts_with("g_a_b");
    for (const auto& row : table.rows) EXPECT_EQ(std::isnan(row[column]), !defined) << name;
  }
  for (const char* pair : {"g of a_c ", "g of b_b ", "g of b_c ", "g of c_c "})
    EXPECT_TRUE(noted(results, pair)) << pair;
  EXPECT_EQ(results.notes.size(), 4u);
  EXPECT_GT(records::mean(results, "g.rms_deviation"), 0.0) << "of the pairs that there are";
  EXPECT_GT(records::mean(results, "g.largest_deviation"), 0.0);
}

TEST(Undefined, DiffusionOfAnEmptySpecies) {
  Scene<2> scene = three_species();
  odpd::Msd<2> msd({.kind = "msd", .name = "msd"},
                   {.window = 1.0, .fit_from = 0.0, .directions = {0, 1}}, scene, 0.25);
  for (int k = 0; k < 9; ++k) {
    for (auto& r : scene.particles().position) r[0] += 0.01;  // ballistic: msd = 0.01^2 k^2
    msd.measure(Clock{}, scene.particles(), records::record(scene));
  }
  const Results results = records::results(msd);
  EXPECT_TRUE(std::isnan(records::mean(results, "diffusion.c")));
  EXPECT_GT(records::mean(results, "diffusion.a"), 0.0);
  EXPECT_NEAR(records::mean(results, "diffusion"), records::mean(results, "diffusion.a"), 1e-15);
  const odpd::Table& table = results.tables.at(0).second;
  ASSERT_EQ(table.columns[5], "msd_c");
  for (const auto& row : table.rows) EXPECT_TRUE(std::isnan(row[5]) && std::isfinite(row[3]));
  EXPECT_TRUE(noted(results, "diffusion of 'c' are undefined"));
  EXPECT_EQ(results.notes.size(), 1u);
}

TEST(Undefined, AnErrorOfUndefinedNumbers) {
  odpd::BlockAverage average(3);
  for (int k = 0; k < 40; ++k)
    average.add(std::vector<double>{std::nan(""), 0.0, static_cast<double>(k % 3)});
  EXPECT_TRUE(std::isnan(average.standard_error(0)));
  EXPECT_EQ(average.standard_error(1), 0.0);
  EXPECT_GT(average.standard_error(2), 0.0);
  const std::vector<odpd::BlockAverage::RatioTerm> nothing{{1.0, 2, 1}};
  EXPECT_TRUE(std::isnan(average.ratio_error(nothing))) << "over a count that stays 0";
}

}  // namespace
