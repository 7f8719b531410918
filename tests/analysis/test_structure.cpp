// The observers of positions: radial distribution, mean-square displacement, density residual.
#include <gtest/gtest.h>

#include <numbers>

#include "odpd/analysis/angular_displacement.h"
#include "odpd/analysis/density_residual.h"
#include "odpd/analysis/least_squares.h"
#include "odpd/analysis/msd.h"
#include "odpd/analysis/rdf.h"
#include "records.h"
#include "support/dimensions.h"
#include "support/errors.h"
#include "support/memory_archive.h"

namespace {

using odpd::Clock;
using odpd::DensityResidual;
using odpd::Msd;
using odpd::MsdSettings;
using odpd::Rdf;
using odpd::Scene;
using odpd::StepRecord;
using odpd::Vec;

template <class T>
class StructureTest : public ::testing::Test {};
TYPED_TEST_SUITE(StructureTest, support::Dimensions);

template <int D>
double ball(double r) {
  return D == 2 ? std::numbers::pi * r * r : 4.0 / 3.0 * std::numbers::pi * r * r * r;
}

// Independent uniform positions. Pairs are pairwise independent, so the number in a bin over all
// samples has the standard error sqrt(n); bound 5 of them per bin, and of the sum of all bins.
TYPED_TEST(StructureTest, AnIdealGasHasNoStructure) {
  constexpr int D = TypeParam::D;
  constexpr std::size_t n = 60, samples = 200, bins = 20;
  const Vec<D> size = support::uniform_vec<D>(4.0);
  auto s = records::periodic<D>(4.0, support::random_points<D>(Vec<D>{}, size, n, 0));
  s.species = {{.name = "a", .fraction = 0.5}, {.name = "b", .fraction = 0.5}};
  s.model = odpd::make_dpd<D>({}, 2);
  const Scene<D> scene(s);
  Rdf<D> rdf({.kind = "rdf", .name = "g"}, {.r_max = 2.0, .bins = bins}, scene);
  StepRecord<D> record;
  record.start.box = scene.box();
  for (std::size_t t = 0; t < samples; ++t) {
    record.start.position = support::random_points<D>(Vec<D>{}, size, n, 1000 + t);
    rdf.measure(Clock{}, scene.particles(), record);
  }
  EXPECT_EQ(rdf.series_row().size(), rdf.series_columns().size());
  const auto results = records::results(rdf);
  ASSERT_EQ(results.tables.size(), 1u);
  const odpd::Table& table = results.tables[0].second;
  EXPECT_EQ(table.columns, (std::vector<std::string>{"r", "g_a_a", "g_a_a_error", "g_a_b",
                                                     "g_a_b_error", "g_b_b", "g_b_b_error"}));
  const std::array<double, 3> pairs{30 * 29 / 2.0, 30 * 30.0, 30 * 29 / 2.0};
  double counted = 0.0, expected_in_all = 0.0;
  for (std::size_t k = 0; k < bins; ++k) {
    const double r = 0.1 * static_cast<double>(k);
    EXPECT_NEAR(table.rows[k][0], r + 0.05, 1e-14);
    for (std::size_t p = 0; p < 3; ++p) {
      const double expected = samples * pairs[p] * (ball<D>(r + 0.1) - ball<D>(r)) / size[0] /
                              size[1] / (D == 3 ? size[D - 1] : 1.0);
      EXPECT_NEAR(table.rows[k][2 * p + 1], 1.0, 5.0 / std::sqrt(expected) + 1.0 / expected)
          << "bin " << k << ", pair " << p;
      counted += expected * table.rows[k][2 * p + 1];
      expected_in_all += expected;
    }
  }
  EXPECT_NEAR(counted / expected_in_all, 1.0, 5.0 / std::sqrt(expected_in_all));
}

// Between walls H apart shells are counted in full where the walls cut them: of a line of length r in a direction at the angle t to
// the normal 1 - r |cos t|/H lies inside, and |cos t| has the mean 1/2 (3D) or 2/pi. Counts as above; bound 6 standard errors.
TYPED_TEST(StructureTest, AnIdealGasBetweenWalls) {
  constexpr int D = TypeParam::D;
  constexpr std::size_t n = 60, samples = 200, bins = 8;
  const Vec<D> size = support::uniform_vec<D>(6.0);
  Vec<D> low{}, high = size;
  low[1] = 1.0;
  high[1] = 4.0 + low[1];
  auto s = records::periodic<D>(6.0, support::random_points<D>(low, high, n, 0));
  records::add_walls(s, 0.0);
  const Scene<D> scene(s);
  Rdf<D> rdf({.kind = "rdf", .name = "g"}, {.r_max = 2.0, .bins = bins}, scene);
  StepRecord<D> record = records::record(scene);
  for (std::size_t t = 0; t < samples; ++t) {
    const auto fluid = support::random_points<D>(low, high, n, 1000 + t);
    std::copy(fluid.begin(), fluid.end(), record.start.position.end() - n);
    rdf.measure(Clock{}, scene.particles(), record);
  }
  const odpd::Results results = records::results(rdf);
  const odpd::Table& table = results.tables.at(0).second;
  EXPECT_EQ(table.comment.size(), 2u) << "a word on walls";
  const double volume = std::pow(6.0, D - 1) * 4.0;
  for (std::size_t k = 0; k < bins; ++k) {
    const double r = table.rows[k][0];
    const double g = 1.0 - r / 4.0 * (D == 3 ? 0.5 : 2.0 / std::numbers::pi);
    const double expected =
        samples * n * (n - 1) / 2.0 * (ball<D>(r + 0.125) - ball<D>(r - 0.125)) / volume * g;
    EXPECT_NEAR(table.rows[k][1], g, 6.0 * g / std::sqrt(expected)) << "bin " << k;
  }
}

TYPED_TEST(StructureTest, OnePairFillsOneBin) {
  constexpr int D = TypeParam::D;
  std::vector<Vec<D>> r(2, support::uniform_vec<D>(0.1));
  r[1][0] = 3.0;  // 1.1 away through the border
  const Scene<D> scene(records::periodic<D>(4.0, r));
  Rdf<D> rdf({.kind = "rdf", .name = "g"}, {.r_max = 2.0, .bins = 5}, scene);
  rdf.measure(Clock{}, scene.particles(), records::record(scene));
  const auto row = rdf.series_row();
  for (std::size_t k = 0; k < 5; ++k) {
    const double shell = ball<D>(1.2) - ball<D>(0.8);
    EXPECT_NEAR(row[k], k == 2 ? std::pow(4.0, D) / shell : 0.0, 1e-10);
  }
}

// A restart may bring other particles than the scene began with.
TEST(Rdf, CountsTheParticlesItIsGiven) {
  auto s = records::periodic<2>(
      4.0, support::random_points<2>(Vec<2>{}, support::uniform_vec<2>(4.0), 40, 3));
  s.species = {{.name = "a", .fraction = 0.5}, {.name = "b", .fraction = 0.5}};
  s.model = odpd::make_dpd<2>({}, 2);
  auto others = s;
  others.start_species.assign(40, 0);
  std::fill_n(others.start_species.begin(), 5, 1);
  const Scene<2> scene(s), other(others);
  Rdf<2> rdf({.kind = "rdf", .name = "g"}, {.r_max = 2.0, .bins = 10}, scene);
  Rdf<2> at_home({.kind = "rdf", .name = "g"}, {.r_max = 2.0, .bins = 10}, other);
  rdf.measure(Clock{}, other.particles(), records::record(other));
  at_home.measure(Clock{}, other.particles(), records::record(other));
  EXPECT_EQ(rdf.series_row(), at_home.series_row());
  at_home.measure(Clock{}, scene.particles(), records::record(scene));
  EXPECT_NE(rdf.series_row(), at_home.series_row());
}

// A scene whose free particles are moved by hand; the image counters carry the crossings.
template <int D>
struct Walkers {
  Scene<D> scene;
  StepRecord<D> record;

  explicit Walkers(std::size_t n)
      : scene(records::periodic<D>(
            4.0, support::random_points<D>(Vec<D>{}, support::uniform_vec<D>(4.0), n, 1))) {}
  template <class Step>
  void run(Msd<D>& msd, int steps, const Step& step) {
    auto& p = scene.particles();
    for (int t = 0; t < steps; ++t) {
      if (t > 0) {
        for (std::size_t i = 0; i < p.position.size(); ++i) {
          p.position[i] += step(static_cast<std::size_t>(p.id[i]), static_cast<std::size_t>(t));
          scene.box().wrap(p.position[i], p.image[i]);
        }
      }
      if (t % 7 == 3) p.reorder(support::random_order(p.position.size(), static_cast<unsigned>(t)));
      msd.measure(Clock{}, p, record);
    }
  }
};

template <int D>
MsdSettings all_directions() {
  MsdSettings m{.window = 1.0, .fit_from = 0.3, .directions = {}};
  for (int c = 0; c < D; ++c) m.directions.push_back(c);
  return m;
}

// Straight flight with velocity v: msd = v^2 t^2 exactly, through the borders and through
// reordering.
TYPED_TEST(StructureTest, BallisticFlight) {
  constexpr int D = TypeParam::D;
  Walkers<D> walkers(20);
  Msd<D> msd({.kind = "msd", .name = "msd"}, all_directions<D>(), walkers.scene, 0.1);
  const auto velocity = support::random_vectors<D>(20, 3);
  walkers.run(msd, 161, [&](std::size_t id, std::size_t) { return 0.1 * velocity[id]; });
  double square = 0.0;
  for (const auto& v : velocity) square += dot(v, v) / 20.0;
  const auto results = records::results(msd);
  const odpd::Table& table = results.tables[0].second;
  ASSERT_EQ(table.rows.size(), 10u);
  std::vector<double> t, y;
  for (std::size_t k = 0; k < 10; ++k) {
    const double lag = 0.1 * static_cast<double>(k + 1);
    EXPECT_NEAR(table.rows[k][0], lag, 1e-12);
    EXPECT_NEAR(table.rows[k][1], square * lag * lag, 1e-11);
    if (k < 2) continue;
    t.push_back(lag);
    y.push_back(square * lag * lag);
  }
  const double slope =
      odpd::fit_polynomial(1, t, y, std::vector<double>(t.size(), 1.0)).coefficient[1];
  EXPECT_NEAR(records::mean(results, "diffusion"), slope / (2 * D), 1e-10);
  EXPECT_LT(records::error(results, "diffusion"), 1e-10);
}

// Independent steps of variance 2 D dt per direction, D = 0.8. The slope over one window of 10 lags
// from one particle and direction has a standard deviation near 2.2 D; so that of 39 windows and N =
// 60 particles is near 2.2 D/sqrt(39 N d) = 2.6 to 3.2 %. The mean is bound by 5 times the reported
// error, which must be of that size.
TYPED_TEST(StructureTest, ARandomWalkDiffuses) {
  constexpr int D = TypeParam::D;
  constexpr double diffusion = 0.8, dt = 0.1;
  Walkers<D> walkers(60);
  Msd<D> msd({.kind = "msd", .name = "msd"}, all_directions<D>(), walkers.scene, dt);
  const odpd::CounterRandom random(1, odpd::Stream::probe);
  walkers.run(msd, 400, [&](std::size_t id, std::size_t t) {
    const auto w = random.normals(t, 0, id, 0);
    Vec<D> step;
    for (std::size_t c = 0; c < D; ++c) step.x[c] = std::sqrt(2.0 * diffusion * dt) * w[c];
    return step;
  });
  const auto results = records::results(msd);
  const double error = records::error(results, "diffusion");
  EXPECT_GT(error, 0.015 * diffusion);
  EXPECT_LT(error, 0.06 * diffusion);
  EXPECT_NEAR(records::mean(results, "diffusion"), diffusion, 5.0 * error);
}

// The same of angles: those of the particles that spin, one component in 2D, whatever stands in the unused one.
TYPED_TEST(StructureTest, ARandomSpinDiffuses) {
  constexpr int D = TypeParam::D;
  constexpr double diffusion = 0.8, dt = 0.05;
  auto settings = records::periodic<D>(
      4.0, support::random_points<D>(Vec<D>{}, support::uniform_vec<D>(4.0), 90, 1));
  settings.species = {{.name = "still"}, {.name = "turning", .lever_radius = 0.5}};
  settings.start_species.resize(90);
  for (std::size_t i = 0; i < 90; ++i) settings.start_species[i] = i < 30 ? 0 : 1;
  settings.model = odpd::make_dpd<D>({.gamma_perp = 1.0}, 2);
  Scene<D> scene(settings);
  auto& p = scene.particles();
  odpd::AngularDisplacement<D> observer({.kind = "rotation", .name = "rotation"}, {1.0, 0.3}, 2,
                                        scene, dt);
  const odpd::CounterRandom random(1, odpd::Stream::probe);
  StepRecord<D> record;
  record.w_mid.resize(90);
  for (std::uint64_t t = 0; t < 800; ++t) {
    for (std::size_t i = 0; i < 90; ++i) {
      const auto w = random.normals(t, 0, static_cast<std::uint64_t>(p.id[i]), 0);
      for (std::size_t c = 0; c < D; ++c)
        record.w_mid[i].x[c] = p.species[i] == 0 ? 1e3 : std::sqrt(2.0 * diffusion / dt) * w[c];
    }
    observer.measure(Clock{}, p, record);
    if (t % 7 == 3) p.reorder(support::random_order(p.position.size(), static_cast<unsigned>(t)));
  }
  const auto results = records::results(observer);
  const double error = records::error(results, "rotation.diffusion");
  EXPECT_GT(error, 0.015 * diffusion);
  EXPECT_LT(error, 0.08 * diffusion);
  EXPECT_NEAR(records::mean(results, "rotation.diffusion"), diffusion, 5.0 * error);
}

TEST(Msd, CountsTheDirectionsAskedAndEverySpecies) {
  Walkers<2> walkers(10);
  MsdSettings m{.window = 0.5, .fit_from = 0.2, .directions = {1}};
  Msd<2> msd({.kind = "msd", .name = "across"}, m, walkers.scene, 0.1);
  walkers.run(msd, 40, [](std::size_t, std::size_t) { return Vec<2>{{1.3, 0.1}}; });
  const auto results = records::results(msd);
  EXPECT_NEAR(results.tables[0].second.rows[4][1], 0.25, 1e-12) << "x does not count";
  EXPECT_NE(results.find("across.diffusion"), nullptr);
}

// Every window of ten lags has a speed of its own: the values are those of one speed each, with no
// step in two of them.
TEST(Msd, WindowsDoNotOverlap) {
  Walkers<2> walkers(10);
  MsdSettings m{.window = 1.0, .fit_from = 0.0, .directions = {0}};
  Msd<2> msd({.kind = "msd", .name = "msd"}, m, walkers.scene, 0.1);
  std::vector<double> t, y;
  for (int k = 1; k <= 10; ++k) {
    t.push_back(0.1 * k);
    y.push_back(t.back() * t.back());
  }
  const double slope = odpd::fit_polynomial(1, t, y, std::vector<double>(10, 1.0)).coefficient[1];
  walkers.run(msd, 1, [](std::size_t, std::size_t) { return Vec<2>{}; });
  for (int window = 1; window <= 17; ++window) {
    for (int k = 1; k <= 10; ++k) {
      EXPECT_TRUE(k == 1 || msd.series_row().empty()) << "sample " << k << " of " << window;
      for (Vec<2>& r : walkers.scene.particles().position) r[0] += 0.1 * window;
      msd.measure(Clock{}, walkers.scene.particles(), walkers.record);
    }
    ASSERT_EQ(msd.series_row().size(), 2u);
    EXPECT_NEAR(msd.series_row()[1], 0.5 * slope * window * window, 1e-8);
    const auto results = records::results(msd);
    EXPECT_TRUE(std::isfinite(records::mean(results, "diffusion")));
    EXPECT_EQ(std::isnan(records::error(results, "diffusion")), window < 16);
  }
}

TEST(Msd, AShortRunSaysSo) {
  Walkers<2> walkers(10);
  Msd<2> msd({.kind = "msd", .name = "msd"}, all_directions<2>(), walkers.scene, 0.1);
  walkers.run(msd, 10, [](std::size_t, std::size_t) { return Vec<2>{}; });
  const auto results = records::results(msd);
  EXPECT_TRUE(std::isnan(records::mean(results, "diffusion")));
  EXPECT_FALSE(results.notes.empty());
}

TEST(Msd, SaveAndLoadMidStream) {
  const auto step = [](std::size_t id, std::size_t t) {
    return 0.3 * support::random_vectors<2>(10, t)[id];
  };
  Walkers<2> walkers(10);
  Walkers<2> others(10);
  const auto make = [&](const Walkers<2>& w) {
    return Msd<2>({.kind = "msd", .name = "msd"}, all_directions<2>(), w.scene, 0.1);
  };
  Msd<2> through = make(walkers), copy = make(others);
  walkers.run(through, 57, step);
  support::MemoryArchive archive, particles;
  through.save(archive);
  walkers.scene.particles().save(particles);
  others.scene.particles().load(particles);
  copy.load(archive);
  for (int t = 0; t < 120; ++t) {
    for (Walkers<2>* w : {&walkers, &others}) {
      auto& p = w->scene.particles();
      const auto moved = p.index_of_id()[static_cast<std::size_t>(t) % 10];
      p.position[static_cast<std::size_t>(moved)][0] += 0.01;
    }
    if (t % 7 == 3) others.scene.particles().reorder(support::random_order(10, 5));
    through.measure(Clock{}, walkers.scene.particles(), walkers.record);
    copy.measure(Clock{}, others.scene.particles(), others.record);
  }
  const auto a = records::results(through), b = records::results(copy);
  EXPECT_EQ(records::mean(a, "diffusion"), records::mean(b, "diffusion"));
  EXPECT_EQ(records::error(a, "diffusion"), records::error(b, "diffusion"));
  support::MemoryArchive first, second;
  through.save(first);
  copy.save(second);
  EXPECT_EQ(first.integers, second.integers);
  EXPECT_EQ(first.doubles, second.doubles);
}

TEST(Msd, ADamagedCheckpointIsRefused) {
  Walkers<2> walkers(10);
  const auto make = [&] {
    return Msd<2>({.kind = "msd", .name = "across"}, all_directions<2>(), walkers.scene, 0.1);
  };
  Msd<2> msd = make();
  support::MemoryArchive fresh, archive;
  msd.save(fresh);
  EXPECT_NO_THROW(make().load(fresh));
  walkers.run(msd, 14, [](std::size_t, std::size_t) { return Vec<2>{{0.1, 0.2}}; });
  msd.save(archive);
  const auto refused = [&](const auto& damage) {
    support::MemoryArchive broken = archive;
    damage(broken);
    support::expect_error<odpd::IoError>([&] { make().load(broken); }, {"across", "damaged"});
  };
  EXPECT_NO_THROW(make().load(archive));
  refused([](auto& a) { a.integers["lag"].clear(); });
  refused([](auto& a) { a.integers["begun"].clear(); });
  refused([](auto& a) { a.integers["lag"][0] = 10; });
  refused([](auto& a) { a.integers["lag"][0] = -1; });
  refused([](auto& a) { a.doubles["origin"].resize(20); });
  refused([](auto& a) { a.doubles["window"].push_back(0.0); });
}

// Counts 3, 1, 0, 0 in bins of volume 1: mean 1, squares 4 + 0 + 1 + 1 = 6.
TEST(DensityResidual, FourParticlesInFourBins) {
  const std::vector<Vec<2>> r{{{0.1, 0.1}}, {{0.9, 0.5}}, {{0.5, 0.9}}, {{1.5, 0.5}}};
  auto s = records::periodic<2>(2.0, r);
  const Scene<2> scene(s);
  DensityResidual<2> residual({.kind = "density-residual", .name = "n"}, {2, 2}, scene);
  StepRecord<2> record;
  record.start.position = r;
  residual.measure(Clock{}, scene.particles(), record);
  EXPECT_NEAR(residual.series_row()[0], std::sqrt(6.0) / 4.0, 1e-14);
  EXPECT_NEAR(residual.series_row()[1], std::sqrt(6.0 / 4.0), 1e-14);
  // Moved to the other bins in a second sample, the averages are 1.5, 0.5, 1.5, 0.5.
  record.start.position = {{{0.1, 1.1}}, {{0.9, 1.5}}, {{0.5, 1.9}}, {{1.5, 1.5}}};
  residual.measure(Clock{}, scene.particles(), record);
  const auto results = records::results(residual);
  EXPECT_NEAR(records::mean(results, "n.thesis"), 0.5, 1e-14);
  EXPECT_NEAR(records::mean(results, "n.paper"), 0.25, 1e-14);
}

// A fixed body next to a corner of a 4 x 4 grid: the four cells around that corner, across the faces, are left out, and the two
// particles in them with them. Counts 3 and eleven times 0: mean 1/4, squares 2.75^2 + 11/16 = 8.25.
TEST(DensityResidual, CellsAroundABodyAreLeftOut) {
  const std::vector<Vec<2>> r{{{1.2, 1.1}}, {{1.9, 1.5}}, {{1.5, 1.9}}, {{3.5, 3.5}}, {{0.5, 0.5}}};
  auto s = records::periodic<2>(4.0, r);
  odpd::BodySettings<2> body;
  body.shape = {{{-0.05, 0.0}}, {{0.05, 0.0}}};
  body.motion = odpd::BodyMotion::fixed;
  body.positions = {{{0.1, 3.9}}};
  s.bodies.push_back(body);
  const Scene<2> scene(s);
  DensityResidual<2> residual({.kind = "density-residual", .name = "n"}, {4, 4}, scene, 1.0);
  EXPECT_EQ(residual.cells(), 12u);
  StepRecord<2> record;
  record.start.position = scene.particles().position;
  residual.measure(Clock{}, scene.particles(), record);
  EXPECT_NEAR(residual.series_row()[0], std::sqrt(8.25) / 12.0, 1e-14);
  EXPECT_NEAR(residual.series_row()[1], std::sqrt(8.25 / 12.0), 1e-14);
}

// Independent positions in every sample: an even fluid shows its noise alone, and of an uneven one the unevenness is left. 25 bins:
// the noise's own number scatters by 1/sqrt(2 * 24) = 14 %, and block errors are up to 20 % high.
TEST(DensityResidual, NoiseIsToldFromUnevenness) {
  constexpr std::size_t n = 200, samples = 512;
  const auto u = support::random_points<2>({}, {{1.0, 1.0}}, n * samples, 3);
  const Scene<2> scene(
      records::periodic<2>(5.0, support::random_points<2>({}, support::uniform_vec<2>(5.0), n, 1)));
  for (const double stretch : {0.0, 0.2}) {
    DensityResidual<2> residual({.kind = "density-residual", .name = "n"}, {5, 5}, scene);
    StepRecord<2> record;
    record.start.position.resize(n);
    for (std::size_t t = 0; t < samples; ++t) {
      for (std::size_t i = 0; i < n; ++i) {
        const Vec<2>& p = u[t * n + i];
        // The first bin along x gets `stretch` of what the others have in excess of their share.
        record.start.position[i] = {
            {i < static_cast<std::size_t>(stretch * n) ? p[0] : 5.0 * p[0], 5.0 * p[1]}};
      }
      residual.measure(Clock{}, scene.particles(), record);
    }
    const auto results = records::results(residual);
    // Densities 8 (1 - stretch) in four columns, and 8 (1 + 4 stretch) in the first: rms 8 * 2 stretch.
    const double uneven = 16.0 * stretch, noise = std::sqrt(8.0 / samples);
    EXPECT_NEAR(records::mean(results, "n.noise"), noise, 0.4 * noise);
    EXPECT_NEAR(records::mean(results, "n.excess"), uneven, stretch > 0.0 ? 0.02 * uneven : noise);
    EXPECT_LT(records::mean(results, "n.excess"), records::mean(results, "n.thesis"));
  }
}

}  // namespace
