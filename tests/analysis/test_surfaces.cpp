// Slabs and drops: what their observers say of configurations whose answer is known.
#include <gtest/gtest.h>

#include <numbers>

#include "odpd/analysis/contact_angle.h"
#include "odpd/analysis/drop.h"
#include "odpd/analysis/surface_tension.h"
#include "odpd/pairs/mdpd.h"
#include "records.h"
#include "support/dimensions.h"
#include "support/errors.h"

namespace {

using odpd::Clock;
using odpd::Config;
using odpd::ContactAngle;
using odpd::Drop;
using odpd::Scene;
using odpd::SurfaceTension;
using odpd::Vec;
using records::mean;

template <class T>
class Surfaces : public ::testing::Test {};
TYPED_TEST_SUITE(Surfaces, support::Dimensions);

// A box of edges 3, 3 (3) and 5 along y, filled at random up to half its height.
template <int D>
odpd::SceneSettings<D> half_filled(std::shared_ptr<const odpd::PairModel<D>> model) {
  Vec<D> low{}, high = support::uniform_vec<D>(3.0);
  high[1] = 2.5;
  auto s = records::periodic<D>(3.0, support::random_points<D>(low, high, 60, 4));
  s.box.size[1] = 5.0;
  s.model = std::move(model);
  return s;
}

template <int D>
std::vector<std::shared_ptr<const odpd::PairModel<D>>> models() {
  return {odpd::make_dpd<D>({.a = 20.0, .gamma = 4.5, .kT = 1.0}),
          std::make_shared<odpd::MdpdModel<D>>(odpd::MdpdFluid{}, 1, std::vector<odpd::MdpdPair>(1),
                                               5.0)};
}

// Per configuration, from the series: the two routes at this strain.
template <int D>
std::vector<double> both_routes(const Scene<D>& scene, double strain) {
  SurfaceTension<D> observer({.kind = "surface-tension", .name = "s"},
                             {.axis = 1, .strain = strain}, scene);
  observer.measure(Clock{}, scene.particles(), records::record(scene));
  return observer.series_row();
}

// The difference goes with the square of the strain, but for rounding: energies of order 1e3 over a strain of 2e-5.
TYPED_TEST(Surfaces, TestAreaGivesTheStressConfigurationByConfiguration) {
  constexpr int D = TypeParam::D;
  for (const auto& model : models<D>()) {
    SCOPED_TRACE(model->name());
    const Scene<D> scene(half_filled<D>(model));
    const auto coarse = both_routes(scene, 2e-4), fine = both_routes(scene, 2e-5);
    EXPECT_GT(std::abs(fine[0]), 1.0);
    EXPECT_NEAR(fine[1], fine[0], 2e-6 * std::abs(fine[0]));
    EXPECT_NEAR(coarse[1], coarse[0], 2e-4 * std::abs(coarse[0]));
  }
}

TYPED_TEST(Surfaces, PressuresAreThoseOfTheSlab) {
  constexpr int D = TypeParam::D;
  const Scene<D> scene(half_filled<D>(models<D>()[0]));
  SurfaceTension<D> observer({.kind = "surface-tension", .name = "s"}, {.axis = 1, .strain = 1e-4},
                             scene);
  for (int k = 0; k < 3; ++k) observer.measure(Clock{}, scene.particles(), records::record(scene));
  const auto results = records::results(observer);
  const double gamma = mean(results, "s.stress");
  EXPECT_NEAR(2.5 * (mean(results, "s.normal_pressure") - mean(results, "s.tangential_pressure")),
              gamma, 1e-9 * std::abs(gamma));
  EXPECT_NEAR(mean(results, "s.test_area"), gamma, 1e-4 * std::abs(gamma));
  const auto record = records::record(scene);
  double virial = 0.0;
  for (std::size_t k = 0; k < record.start.network.r.size(); ++k)
    virial += record.start.network.r[k] * record.start.network.f_c[k];
  const double trace =
      mean(results, "s.normal_pressure") + (D - 1) * mean(results, "s.tangential_pressure");
  EXPECT_NEAR(trace, (D * 60.0 + virial) / scene.box().volume(), 1e-9 * std::abs(virial));
}

// Points of a cubic lattice of spacing `a` within a ball about `centre`, put into the box.
template <int D>
std::vector<Vec<D>> ball(const odpd::Box<D>& box, const Vec<D>& centre, double radius, double a) {
  std::vector<Vec<D>> points{centre};
  for (int c = 0; c < D; ++c) {
    std::vector<Vec<D>> more;
    for (const Vec<D>& point : points)
      for (double x = -std::floor(radius / a); x <= radius / a; x += 1.0) {
        more.push_back(point);
        more.back()[c] += a * x;
      }
    points = more;
  }
  std::erase_if(points, [&](const Vec<D>& r) { return norm(r - centre) > radius; });
  for (Vec<D>& r : points) box.wrap(r);
  return points;
}

// Across the corner of the box.
TYPED_TEST(Surfaces, ADropHasItsCentreItsRadiusAndItsPressure) {
  constexpr int D = TypeParam::D;
  constexpr double edge = 10.0, a = 0.3, radius = 3.05;
  auto s = records::periodic<D>(edge, {});
  const Vec<D> centre = support::uniform_vec<D>(9.9);
  s.start_positions = ball<D>(s.box, centre, radius, a);
  s.model = odpd::make_dpd<D>({.a = 20.0, .gamma = 4.5, .kT = 1.0});
  const Scene<D> scene(s);
  const Vec<D> found = odpd::centre_of_mass(s.box, scene.particles(), scene.particles().position);
  EXPECT_LT(norm(s.box.separation(found, centre)), 1e-12);
  Drop<D> drop({.kind = "drop", .name = "drop"}, {.core = 1.7, .r_max = 5.0, .bin = 0.1}, scene);
  drop.measure(Clock{}, scene.particles(), records::record(scene));
  const auto results = records::results(drop);
  const double density = std::pow(a, -D);
  EXPECT_NEAR(mean(results, "drop.core_density"), density, 0.03 * density);
  EXPECT_NEAR(mean(results, "drop.equimolar_radius"), radius, 0.03 * radius);
  EXPECT_EQ(mean(results, "drop.vapour_density"), 0.0);
  // The stress of a lattice is the same everywhere: sum over its vectors of R f(R)/(2 d) in a cell.
  double virial = 0.0;
  for (const Vec<D>& r :
       ball<D>({support::uniform_vec<D>(1e9), {}}, support::uniform_vec<D>(50.0), 1.0, a))
    if (const double R = norm(r - support::uniform_vec<D>(50.0)); R > 0.0)
      virial += R * 20.0 * (1.0 - R);
  const double conservative = virial * density / (2.0 * D);
  EXPECT_NEAR(mean(results, "drop.core_pressure") - mean(results, "drop.core_density"),
              conservative, 0.05 * conservative);
  EXPECT_NEAR(
      mean(results, "drop.laplace"),
      mean(results, "drop.equimolar_radius") * mean(results, "drop.core_pressure") / (D - 1), 1e-9);
}

// A cap cut into thin slices, the chords of which are known: volume and centre by hand.
TYPED_TEST(Surfaces, CapsHaveTheirHeights) {
  constexpr int D = TypeParam::D;
  for (const double degrees : {20.0, 90.0, 150.0}) {
    const double angle = degrees * std::numbers::pi / 180.0, foot = -std::cos(angle);
    constexpr int slices = 20000;
    double volume = 0.0, moment = 0.0;
    for (int k = 0; k < slices; ++k) {
      const double thickness = (1.0 + foot) / slices, y = (k + 0.5) * thickness;
      const double half = std::sqrt(std::max(0.0, 1.0 - (y - foot) * (y - foot)));
      const double slice = (D == 2 ? 2.0 * half : std::numbers::pi * half * half) * thickness;
      volume += slice;
      moment += slice * y;
    }
    const double ratio = moment / volume / std::pow(volume, 1.0 / D);
    EXPECT_NEAR(odpd::cap_height<D>(angle), ratio, 1e-4 * ratio) << degrees;
    EXPECT_NEAR(odpd::cap_angle<D>(ratio), degrees, 0.05);
  }
  EXPECT_TRUE(std::isnan(odpd::cap_angle<D>(-0.1)));
  EXPECT_TRUE(std::isnan(odpd::cap_angle<D>(0.7)));
}

// Half a disk, of a lattice of density 25, on the wall that is named: 90 degrees.
TEST(ContactAngles, HalfADiskHasARightAngle) {
  const odpd::Box<2> box{{{12.0, 12.0}}, {}};
  for (const bool high : {false, true}) {
    std::vector<Vec<2>> points;
    for (const Vec<2>& r : ball<2>(box, {{6.0, high ? 11.1 : 0.9}}, 4.0, 0.2))
      if (r[1] > 1.0 && r[1] < 11.0) points.push_back(r);
    auto s = records::periodic<2>(12.0, points);
    records::add_walls(s, 0.0);
    const Scene<2> scene(s);
    ContactAngle<2> observer({.kind = "contact-angle", .name = "drop"},
                             {.wall = high ? 1u : 0u, .density = 25.0}, scene);
    observer.measure(Clock{}, scene.particles(), records::record(scene));
    EXPECT_NEAR(mean(records::results(observer), "drop.degrees"), 90.0, 2.0);
    ContactAngle<2> other({.kind = "contact-angle", .name = "drop"},
                          {.wall = high ? 0u : 1u, .density = 25.0}, scene);
    other.measure(Clock{}, scene.particles(), records::record(scene));
    const auto results = records::results(other);
    EXPECT_TRUE(std::isnan(mean(results, "drop.degrees")));
    EXPECT_EQ(results.notes.size(), 1u);
  }
}

TEST(SurfaceKeys, AreRefusedWhereTheyMakeNoSense) {
  auto s = half_filled<2>(models<2>()[1]);
  const auto refuses = [](const odpd::SceneSettings<2>& settings, auto make,
                          const std::string& keys, std::initializer_list<const char*> parts) {
    const Scene<2> scene(settings);
    const Clock clock;
    const Config config = Config::from_text(keys, "case.toml");
    support::expect_error<odpd::ConfigError>([&] { make({"kind", config, scene, clock}); }, parts);
  };
  const auto tension = [](const odpd::ObserverEntry<2>& e) { SurfaceTension<2>::make(e); };
  const auto drop = [](const odpd::ObserverEntry<2>& e) { Drop<2>::make(e); };
  const auto angle = [](const odpd::ObserverEntry<2>& e) { ContactAngle<2>::make(e); };
  refuses(s, tension, "strain = 0.2", {"strain", "at most 0.1"});
  refuses(s, drop, "", {"core"});
  refuses(s, drop, "core = 0.5\nr_max = 1.6", {"r_max", "1.5"});
  refuses(s, drop, "core = 1.2", {"core", "1.125"});
  refuses(s, drop, "core = 0.5\nbin = 0.5", {"bin", "1.5"});
  refuses(s, angle, "", {"kind", "[[wall]]"});
  s.box.size[0] = 2.0;
  refuses(s, tension, "strain = 0.01", {"strain", "two cutoffs", "2.02"});
  records::add_walls(s, 0.0);
  s.box.size = support::uniform_vec<2>(5.0);
  refuses(s, tension, "", {"kind", "slab"});
  refuses(s, drop, "core = 0.5", {"kind", "contact-angle"});
  refuses(s, angle, "wall = \"x-\"", {"wall", "y-"});
}

}  // namespace
