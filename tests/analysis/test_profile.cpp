#include <gtest/gtest.h>

#include "odpd/analysis/profile.h"
#include "records.h"
#include "support/dimensions.h"
#include "support/memory_archive.h"

namespace {

using odpd::Clock;
using odpd::Profile;
using odpd::ProfileFit;
using odpd::ProfileSettings;
using odpd::Scene;
using odpd::SceneSettings;
using odpd::StepRecord;
using odpd::Vec;

constexpr int bins = 8;

// A channel of height 4 between surfaces at 1 and 5 moving with -+ 1, one particle in the middle of
// each of 8 bins; no forces, so that the velocities are all there is.
template <int D>
SceneSettings<D> channel() {
  std::vector<Vec<D>> r(bins, support::uniform_vec<D>(2.0));
  for (int k = 0; k < bins; ++k) r[static_cast<std::size_t>(k)][1] = 1.25 + 0.5 * k;
  auto s = records::periodic<D>(6.0, r);
  records::add_walls(s, 1.0);
  s.model = odpd::make_dpd<D>({.a = 0.0});
  return s;
}

/// `samples` records of v_x = field(y) plus noise, which the second half of the samples takes back.
template <int D, class Field>
void measure(Profile<D>& profile, const Scene<D>& scene, int samples, const Field& field) {
  StepRecord<D> record = records::record(scene);
  const auto noise = support::random_numbers(static_cast<std::size_t>(samples), 4);
  for (int t = 0; t < samples; ++t) {
    for (std::size_t i = 0; i < record.v_mid.size(); ++i) {
      if (!scene.particles().is_free(i)) continue;
      const int half = samples / 2;
      const double w = t < half ? noise[static_cast<std::size_t>(t)]
                                : -noise[static_cast<std::size_t>(t - half)];
      record.v_mid[i][0] = field(scene.particles().position[i][1]) + 0.01 * w;
    }
    profile.measure(Clock{}, scene.particles(), record);
  }
}

template <int D>
Profile<D> make(const Scene<D>& scene, ProfileFit fit, double from = 1.0, double to = 5.0) {
  const ProfileSettings settings{
      .axis = 1, .bins = bins, .fit = fit, .component = 0, .fit_from = from, .fit_to = to};
  return Profile<D>({.kind = "profile", .name = "u"}, settings, scene);
}

template <class T>
class ProfileTest : public ::testing::Test {};
TYPED_TEST_SUITE(ProfileTest, support::Dimensions);

TYPED_TEST(ProfileTest, ALinearFieldGivesItsSlope) {
  constexpr int D = TypeParam::D;
  const Scene<D> scene(channel<D>());
  Profile<D> profile = make(scene, ProfileFit::linear);
  measure(profile, scene, 400, [](double y) { return 0.3 * (y - 2.0); });
  const auto results = records::results(profile);
  EXPECT_NEAR(records::mean(results, "u.slope"), 0.3, 1e-12);
  EXPECT_NEAR(records::mean(results, "u.slope_ratio"), 0.6, 1e-12);
  EXPECT_NEAR(records::mean(results, "u.slip_length"), 0.5 * (2.0 / 0.3 - 4.0), 1e-10);
  EXPECT_GE(records::error(results, "u.slope"), 0.0);
  const double bin_volume = 0.5 * std::pow(6.0, D - 1);
  EXPECT_NEAR(records::mean(results, "u.bulk_density"), 1.0 / bin_volume, 1e-13);
  ASSERT_EQ(results.tables.size(), 1u);
  const odpd::Table& table = results.tables[0].second;
  ASSERT_EQ(table.rows.size(), static_cast<std::size_t>(bins));
  for (std::size_t k = 0; k < bins; ++k) {
    ASSERT_EQ(table.rows[k].size(), table.columns.size());
    const double y = 1.25 + 0.5 * static_cast<double>(k);
    EXPECT_NEAR(table.rows[k][0], y, 1e-14);
    EXPECT_NEAR(table.rows[k][1], 1.0 / bin_volume, 1e-14);
    EXPECT_NEAR(table.rows[k][3], 0.3 * (y - 2.0), 1e-13);
    EXPECT_NEAR(table.rows[k][5], 0.0, 1e-15) << "v_y";
  }
}

// v_mid counts where the particle was in the middle of its step, not where it started.
TYPED_TEST(ProfileTest, ParticlesCountAtTheMiddleOfTheirStep) {
  constexpr int D = TypeParam::D;
  const Scene<D> scene(channel<D>());
  Profile<D> profile = make(scene, ProfileFit::none);
  StepRecord<D> record = records::record(scene);
  record.dt = 0.1;
  record.v_mid.back()[1] = -6.0;  // half of the path of -0.6 leads from bin 7 to bin 6
  profile.measure(Clock{}, scene.particles(), record);
  const auto row = profile.series_row();
  ASSERT_EQ(row.size(), profile.series_columns().size());
  EXPECT_EQ(row[2 * 7], 0.0);
  EXPECT_EQ(row[2 * 6], 2.0);
  record.v_mid.back()[1] = 6.0;  // behind the upper surface
  profile.measure(Clock{}, scene.particles(), record);
  EXPECT_EQ(profile.series_row()[2 * 7], 0.0) << "a particle behind the surface is in no bin";
}

TYPED_TEST(ProfileTest, AParabolaGivesTheViscosity) {
  constexpr int D = TypeParam::D;
  auto s = channel<D>();
  for (auto& wall : s.walls) wall.velocity = {};
  s.body_force[0] = 0.05;
  const Scene<D> scene(s);
  Profile<D> profile = make(scene, ProfileFit::parabola);
  // u = (f n/2 eta) ((2 + b)^2 - (y - 3)^2) with a slip length b = 0.25
  measure(profile, scene, 400,
          [](double y) { return 0.2 * (2.25 * 2.25 - (y - 3.0) * (y - 3.0)); });
  const auto results = records::results(profile);
  const double density = 1.0 / (0.5 * std::pow(6.0, D - 1));
  EXPECT_NEAR(records::mean(results, "u.curvature"), -0.2, 1e-11);
  EXPECT_NEAR(records::mean(results, "u.viscosity"), density * 0.05 / 0.4, 1e-11);
  EXPECT_NEAR(records::mean(results, "u.maximum"), 0.2 * 2.25 * 2.25, 1e-11);
  EXPECT_NEAR(records::mean(results, "u.slip_length"), 0.25, 1e-10);
}

TYPED_TEST(ProfileTest, OnlyBinsInTheRangeAreFitted) {
  constexpr int D = TypeParam::D;
  const Scene<D> scene(channel<D>());
  Profile<D> profile = make(scene, ProfileFit::linear, 2.0, 4.0);
  measure(profile, scene, 400,
          [](double y) { return y < 2.0 || y > 4.0 ? 77.0 : 0.5 * (y - 3.0); });
  EXPECT_NEAR(records::mean(records::results(profile), "u.slope"), 0.5, 1e-12);
}

// Slopes of independent noise: their scatter over 60 series against the reported error. Standard
// error of the ratio of variances: sqrt(2/60) = 18 %; the block estimate is 0 to 30 % high in the
// error.
TEST(Profile, TheErrorOfTheSlopeIsThatOfRepeatedRuns) {
  const Scene<2> scene(channel<2>());
  double square = 0.0, reported = 0.0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Profile<2> profile = make(scene, ProfileFit::linear);
    StepRecord<2> record = records::record(scene);
    const auto noise = support::random_numbers(200 * bins, seed);
    for (std::size_t t = 0; t < 200; ++t) {
      std::size_t k = 0;
      for (std::size_t i = 0; i < record.v_mid.size(); ++i) {
        if (!scene.particles().is_free(i)) continue;
        record.v_mid[i][0] = scene.particles().position[i][1] + noise[t * bins + k++];
      }
      profile.measure(Clock{}, scene.particles(), record);
    }
    const auto results = records::results(profile);
    square += std::pow(records::mean(results, "u.slope") - 1.0, 2) / 60.0;
    reported += records::error(results, "u.slope") / 60.0;
  }
  EXPECT_GT(reported / std::sqrt(square), 0.75);
  EXPECT_LT(reported / std::sqrt(square), 1.6);
}

TEST(Profile, WithoutScatterThereIsNoFitButANote) {
  const Scene<2> scene(channel<2>());
  Profile<2> profile = make(scene, ProfileFit::linear);
  EXPECT_TRUE(records::results(profile).tables.empty()) << "nothing was measured yet";
  profile.measure(Clock{}, scene.particles(), records::record(scene));
  const auto results = records::results(profile);
  EXPECT_TRUE(std::isnan(records::mean(results, "u.slope")));
  EXPECT_EQ(results.charts[0].second.curves.size(), 1u) << "no line of a fit";
  EXPECT_FALSE(results.notes.empty());
}

TEST(Profile, SaveAndLoadMidStream) {
  const Scene<2> scene(channel<2>());
  Profile<2> through = make(scene, ProfileFit::linear), copy = make(scene, ProfileFit::linear);
  const auto field = [](double y) { return 0.1 * y; };
  measure(through, scene, 100, field);
  support::MemoryArchive archive;
  through.save(archive);
  copy.load(archive);
  for (Profile<2>* profile : {&through, &copy}) measure(*profile, scene, 60, field);
  const auto a = records::results(through), b = records::results(copy);
  EXPECT_EQ(a.tables[0].second.rows.back()[4], b.tables[0].second.rows.back()[4]);
  EXPECT_EQ(records::error(a, "u.slope"), records::error(b, "u.slope"));
}

}  // namespace
