// What observers say of particles that spin: torques that balance, a stress that is symmetric, a balance of heat that closes.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/app/simulation.h"

namespace odpd {
namespace {

// Particles that spin, in a periodic square; `more` are tables of the case, `fluid` keys of [fluid]; none:
// no noise.
Results of_spins(const std::string& fluid, const std::string& more,
                 const std::string& numbers = "tolerance = 1e-10",
                 const std::string& length = "6.0") {
  const Config config = Config::from_text(
      "dimension = 2\n[box]\nsize = [" + length + ", " + length + "]\nperiodic = [true, true]\n" +
          "[fluid]\na = 18.5\ngamma = 4.5\ngamma_perp = 4.5\nlever_radius = 0.5\n" + fluid +
          (fluid.empty() ? "kT = 0.0" : "\nkT = 1.0") + "\n[integrator]\ndt = 0.005\n[solver]\n" +
          numbers + "\n" + more,
      "case.toml");
  Simulation<2> simulation(config, read_case(config, "spins"));
  simulation.run([] { return false; }, [] {});
  return simulation.results();
}

const std::string observed =
    "[run]\nequilibrate = 0.1\nduration = 0.1\n[[observe]]\nkind = \"stress\"\n";

// Without the torques on disks that are turned, heat is missing.
TEST(SpinObservers, TheBalanceOfHeatCloses) {
  const std::string heat = observed + "[[observe]]\nkind = \"heat\"\n";
  const std::string disk = "[[body]]\nshape = \"disk\"\nradius = 0.6\npositions = [{ at = [3.0, ";
  for (const std::string& scene :
       {heat, heat + "[shear]\nrate = 1.0\n",
        heat + disk + "3.0] }]\nforce = [2.0, 1.0]\ntorque = 3.0\n",
        heat + disk + "3.0] }]\nmotion = \"given\"\nangular_velocity = 2.0\n[[body]]\nname = " +
            "\"fixed\"\nshape = \"disk\"\nradius = 0.4\nmotion = \"fixed\"\npositions = [{ at = " +
            "[0.5, 0.5] }]\n",
        heat + "[shear]\nrate = 1.0\n" + disk + "0.1] }]\ntorque = 3.0\n"}) {
    SCOPED_TRACE(scene);
    const Results results = of_spins("count = 144", scene);
    EXPECT_LT(results.find("heat.residual")->mean, 1e-7);
    EXPECT_GT(std::abs(results.find("heat.produced")->mean), 0.0);
  }
}

// The torques on a particle without moment of inertia balance, and with them the stress is symmetric. A moment of inertia takes up
// the difference.
TEST(SpinObservers, TheStressIsSymmetricWithoutMomentsOfInertia) {
  const std::string shear = observed + "[shear]\nrate = 1.0\n";
  const auto difference = [](const Results& results) {
    return std::abs(results.find("stress.xy")->mean - results.find("stress.yx")->mean);
  };
  const Results still = of_spins("count = 144", shear);
  EXPECT_LT(difference(still), 1e-6);
  EXPECT_GT(std::abs(still.find("stress.xy")->mean), 0.5);
  EXPECT_GT(difference(of_spins("count = 144\nmass = 1.0", shear)), 1e-3);
}

// On two bodies about one centre, of which one is turned and one is held, act opposite torques: at mass 0 the fluid takes up none. Of
// forces on their particles alone this does not hold. The pairs of the two are no edges, and the ring keeps no fluid in.
TEST(SpinObservers, TorquesOnBodiesBalance) {
  const std::string bodies =
      "[run]\nduration = 0.02\n[[observe]]\nkind = \"bodies\"\nr_max = 2.0\nevery = 1\n"
      "[[body]]\nname = \"inner\"\nshape = \"disk\"\nradius = 0.4\nmotion = \"given\"\n"
      "angular_velocity = 3.0\npositions = [{ at = [6.0, 6.0] }]\n"
      "[[body]]\nname = \"outer\"\nshape = \"ring\"\nradius = 2.5\npoints_on_ring = 40\n"
      "motion = \"fixed\"\npositions = [{ at = [6.0, 6.0] }]\n";
  std::string start = "[start]\nfrom = \"file\"\nfile = \"";
  const std::string file = testing::TempDir() + "odpd_spins_in_a_ring.csv";
  std::string rows = "x,y\n";
  for (int i = -9; i <= 9; ++i)
    for (int j = -9; j <= 9; ++j)
      if (const double x = 0.23 * i + 0.013 * j, y = 0.23 * j - 0.021 * i, r = std::hypot(x, y);
          r > 0.7 && r < 2.2)
        rows += std::to_string(6.0 + x) + "," + std::to_string(6.0 + y) + "\n";
  std::FILE* out = std::fopen(file.c_str(), "w");
  ASSERT_NE(out, nullptr);
  std::fputs(rows.c_str(), out);
  std::fclose(out);
  const Results results = of_spins("", bodies + start + file + "\"\n", "tolerance = 1e-10", "12.0");
  const double inner = results.find("bodies.inner.torque")->mean;
  EXPECT_GT(std::abs(inner), 10.0);
  EXPECT_NEAR(inner + results.find("bodies.outer.torque")->mean, 0.0, 1e-6 * std::abs(inner));
}

// T_rot is kT with the moment of a disk and with a tenth of it; the spins of a sheared fluid turn with half its rate, which is no heat.
TEST(SpinObservers, TheRotationalTemperatureIsThatOfTheFluid) {
  const std::string run =
      "[run]\nequilibrate = 1.0\nduration = 12.0\n[[observe]]\nkind = \"thermo\"\nevery = 2\n";
  for (const std::string keys : {"moment = 0.125", "moment = 0.0125"}) {
    SCOPED_TRACE(keys);
    const Results results = of_spins("count = 144\nmass = 1.0\n" + keys, run, "tolerance = 1e-3");
    const Scalar& rotation = *results.find("rotational_temperature");
    EXPECT_LT(rotation.standard_error, 0.01);
    EXPECT_NEAR(rotation.mean, 1.0, 0.01 + 4.0 * rotation.standard_error);
  }
  EXPECT_EQ(of_spins("count = 144", observed + "[[observe]]\nkind = \"thermo\"\n")
                .find("rotational_temperature"),
            nullptr);
  const Results sheared =
      of_spins("count = 144\nmass = 1.0\nmoment = 1.0",
               run + "[shear]\nrate = 2.0\n[[observe]]\nkind = \"profile\"\n", "tolerance = 1e-3");
  const Table* profile = nullptr;
  for (const auto& [name, table] : sheared.tables)
    if (name == "profile") profile = &table;
  ASSERT_NE(profile, nullptr);
  ASSERT_EQ(profile->columns[profile->columns.size() - 2], "w_z");
  double w = 0.0;
  for (const auto& row : profile->rows)
    w += row[row.size() - 2] / static_cast<double>(profile->rows.size());
  EXPECT_NEAR(w, -1.0, 0.05);
  // Not relative to the flow it would be larger by I w^2 = 1.
  EXPECT_NEAR(sheared.find("rotational_temperature")->mean, 1.0, 0.2);
}

}  // namespace
}  // namespace odpd
