// The observer of the amplitude of a wave: what it projects on, the viscosity under a force, and the rate of a decay with its error.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "odpd/analysis/wave_amplitude.h"
#include "odpd/core/random.h"
#include "records.h"
#include "support/dimensions.h"
#include "support/memory_archive.h"

namespace {

using odpd::FlowWave;
using odpd::WaveAmplitude;

template <class T>
class WaveAmplitudeTest : public ::testing::Test {};
TYPED_TEST_SUITE(WaveAmplitudeTest, support::Dimensions);

constexpr double wave_edge = 6.0;

/// 30 particles at random and vortices in the plane of the first and the last direction.
template <int D>
odpd::SceneSettings<D> vortices(bool driven) {
  auto s = records::periodic<D>(
      wave_edge, support::random_points<D>({}, support::uniform_vec<D>(wave_edge), 30, 3));
  s.mass = driven ? 0.0 : 2.0;
  const FlowWave wave{.along = D - 1, .number = 2, .shape = FlowWave::Shape::taylor_green};
  (driven ? s.force_wave : s.start_wave) = wave;
  (driven ? s.body_force : s.start_velocity)[0] = 0.3;
  return s;
}

template <int D>
void see(WaveAmplitude<D>& observer, const odpd::Scene<D>& scene, double amplitude) {
  auto record = records::record(scene);
  record.dt = 1e-9;  // the middle of the path is its start
  const double k = 2.0 * std::numbers::pi * 2.0 / wave_edge;
  for (std::size_t i = 0; i < record.v_mid.size(); ++i) {
    const auto& r = record.start.position[i];
    record.v_mid[i] = {};
    record.v_mid[i][0] = amplitude * std::sin(k * r[0]) * std::cos(k * r[D - 1]);
    record.v_mid[i][D - 1] = -amplitude * std::cos(k * r[0]) * std::sin(k * r[D - 1]);
  }
  observer.measure(odpd::Clock{}, scene.particles(), record);
}

TYPED_TEST(WaveAmplitudeTest, OfAForceTellsTheViscosityAtItsWavelength) {
  constexpr int D = TypeParam::D;
  const odpd::Scene<D> scene(vortices<D>(true));
  WaveAmplitude<D> observer({.kind = "wave", .name = "w"}, scene, 0.1);
  for (int t = 0; t < 100; ++t) see(observer, scene, 0.7 + (t % 2 == 0 ? 0.1 : -0.1));
  const auto results = records::results(observer);
  EXPECT_NEAR(records::mean(results, "w.amplitude"), 0.7, 1e-9);
  const double k2 = 2.0 * std::pow(2.0 * std::numbers::pi * 2.0 / wave_edge, 2);
  const double n = 30.0 / std::pow(wave_edge, D);
  EXPECT_NEAR(records::mean(results, "w.viscosity"), n * 0.3 / (k2 * 0.7), 1e-9);
  EXPECT_EQ(results.find("w.decay_rate"), nullptr);
}

// An Ornstein-Uhlenbeck process of known rate, from 33 standard deviations: 200 runs scatter as their standard errors say, and
// their mean is right to 3.5 of its own. A pure exponential has no error.
TYPED_TEST(WaveAmplitudeTest, OfADecayTellsItsRateAndError) {
  constexpr int D = TypeParam::D;
  const odpd::Scene<D> scene(vortices<D>(false));
  constexpr double dt = 0.04, rate = 0.5, deviation = 0.03;
  WaveAmplitude<D> exact({.kind = "wave", .name = "w"}, scene, dt);
  for (int t = 0; t <= 100; ++t) see(exact, scene, std::exp(-rate * dt * t));
  const auto results = records::results(exact);
  EXPECT_NEAR(records::mean(results, "w.decay_rate"), rate, 2e-5);
  EXPECT_LT(records::error(results, "w.decay_rate"), 1e-5);
  const double k2 = 2.0 * std::pow(2.0 * std::numbers::pi * 2.0 / wave_edge, 2);
  EXPECT_NEAR(records::mean(results, "w.viscosity"),
              2.0 * 30.0 / std::pow(wave_edge, D) / k2 * rate, 1e-4);
  if (D > 2) return;
  constexpr int runs = 200;
  double sum = 0.0, squares = 0.0, told = 0.0;
  for (int run = 0; run < runs; ++run) {
    WaveAmplitude<D> observer({.kind = "wave", .name = "w"}, scene, dt);
    const odpd::CounterRandom random(static_cast<std::uint64_t>(run),
                                     odpd::Stream::start_velocities);
    double a = 1.0;
    const double keep = std::exp(-rate * dt);
    for (int t = 0; t <= 100; ++t) {
      see(observer, scene, a);
      a = keep * a + deviation * std::sqrt(1.0 - keep * keep) *
                         random.normals(0, 0, static_cast<std::uint64_t>(t), 0)[0];
    }
    const auto of_run = records::results(observer);
    const double miss = records::mean(of_run, "w.decay_rate") - rate;
    sum += miss / runs;
    squares += miss * miss / runs;
    told += std::pow(records::error(of_run, "w.decay_rate"), 2) / runs;
  }
  EXPECT_NEAR(std::sqrt(told / squares), 1.0, 0.2);
  EXPECT_NEAR(sum, 0.0, 3.5 * std::sqrt(squares / runs));
  EXPECT_LT(std::sqrt(squares), 2.8 * deviation * rate) << "2 would be the best there is";
}

TYPED_TEST(WaveAmplitudeTest, ContinuesADecay) {
  constexpr int D = TypeParam::D;
  const odpd::Scene<D> scene(vortices<D>(false));
  WaveAmplitude<D> through({.kind = "wave", .name = "w"}, scene, 0.1),
      restarted({.kind = "wave", .name = "w"}, scene, 0.1);
  for (int t = 0; t < 20; ++t) see(through, scene, 1.0 / (1.0 + t));
  support::MemoryArchive archive;
  through.save(archive);
  restarted.load(archive);
  for (auto* observer : {&through, &restarted}) see(*observer, scene, 0.01);
  for (const char* what : {"w.decay_rate", "w.viscosity", "w.amplitude"})
    EXPECT_EQ(records::mean(records::results(through), what),
              records::mean(records::results(restarted), what));
}

}  // namespace
