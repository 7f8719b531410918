// Whole runs by several ranks: scene, steps, observers and judgements are those of one rank, and the same bits on each.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "odpd/app/simulation.h"
#include "on_ranks.h"

namespace {

using odpd::Communicator;
using odpd::Config;

struct RankedRun {
  const char* label;
  const char* text;
};

const std::string ranked_fluid = R"(
dimension = 2
seed = 4
[fluid]
density = 4.0
kT = 1.0
a = 18.5
gamma = 4.5
)";
// Of the runs without another.
const std::string ranked_box = R"(
[box]
size = [5.0, 5.0]
periodic = [true, true]
)";
// What the runs share after their own tables; 16 measured steps, so that windows of 4 end.
const std::string ranked_end = R"(
[solver]
tolerance = 1e-11
[neighbours]
reorder_every = 5
[run]
equilibrate = 0.02
duration = 0.08
[[observe]]
kind = "thermo"
every = 1
)";

const std::vector<RankedRun> ranked_runs{{"channel", R"(
[box]
size = [5.0, 6.0]
periodic = [true, false]
[[wall]]
side = "y-"
layers = [{ depth = 0.0, count = 20 }, { depth = 0.5, count = 10 }]
[[wall]]
side = "y+"
velocity = [3.0, 0.0]
layers = [{ depth = 0.0, count = 20 }, { depth = 0.5, count = 10 }]
[integrator]
dt = 0.005
[[observe]]
kind = "profile"
bins = 8
axis = "y"
[[observe]]
kind = "wall-force"
[[observe]]
kind = "stress"
bins = 4
[[observe]]
kind = "heat"
[[observe]]
kind = "divergence"
bins = [3, 3]
[[observe]]
kind = "density-residual"
bins = [3, 3]
[[observe]]
kind = "rdf"
every = 4
r_max = 2.0
bins = 10
[[observe]]
kind = "msd"
window = 0.02
fit_from = 0.01
every = 1
)"},
                                         {"sheared_with_mass", R"(
[shear]
flow = "x"
gradient = "y"
rate = 1.0
[integrator]
dt = 0.005
[[observe]]
kind = "viscosity"
[[observe]]
kind = "profile"
bins = 5
[[observe]]
kind = "velocities"
every = 1
bins = 10
)"},
                                         {"sheared", R"(
[shear]
flow = "x"
gradient = "y"
rate = 1.0
[integrator]
dt = 0.005
[[observe]]
kind = "heat"
)"},
                                         {"bodies", R"(
[[body]]
name = "ring"
shape = "ring"
radius = 0.3
points_on_ring = 6
count = 2
force = [2.0, 0.0]
[integrator]
dt = 0.005
[[observe]]
kind = "bodies"
every = 1
window = 0.02
fit_from = 0.01
[[observe]]
kind = "stress"
[[observe]]
kind = "heat"
)"},
                                         {"molecules", R"(
[[species]]
name = "solvent"
[[species]]
name = "bead"
count = 0
[[molecule]]
name = "triangle"
shape = "simplex"
spacing = 0.25
species = "bead"
H = 200.0
count = 7
[integrator]
dt = 0.005
[[observe]]
kind = "molecules"
every = 1
window = 0.02
fit_from = 0.01
)"},
                                         {"at_rest", R"(
[integrator]
name = "midpoint"
dt = 0.005
[[observe]]
kind = "viscosity"
window = 0.02
)"},
                                         {"controlled", R"(
[[body]]
name = "ring"
shape = "ring"
radius = 0.3
points_on_ring = 6
count = 2
[integrator]
dt = 0.005
[[observe]]
kind = "viscosity"
window = 0.02
control = true
control_tolerance = 1e-9
[[observe]]
kind = "modes"
numbers = [1, 3]
window = 0.04
control = true
control_every = 2
control_tolerance = 1e-9
)"},
                                         {"frozen", R"(
[[body]]
name = "ring"
shape = "ring"
radius = 0.3
points_on_ring = 6
count = 2
[integrator]
dt = 0.005
[[observe]]
kind = "mobility"
every = 8
sample = 1
collective = true
tolerance = 1e-9
[[observe]]
kind = "high-frequency-viscosity"
every = 8
tolerance = 1e-9
)"},
                                         {"implicit", R"(
[integrator]
name = "implicit"
dt = 0.005
)"},
                                         {"extrapolated_with_bodies", R"(
[[body]]
name = "ring"
shape = "ring"
radius = 0.3
points_on_ring = 6
count = 2
[integrator]
name = "extrapolated"
dt = 0.005
)"},
                                         {"setd", R"(
[integrator]
name = "setd"
order = 2
dt = 0.005
)"},
                                         {"velocity_verlet", R"(
[integrator]
name = "velocity-verlet"
dt = 0.005
[[observe]]
kind = "modes"
numbers = [1, 4]
window = 0.04
)"},
                                         {"shardlow", R"(
[integrator]
name = "shardlow"
dt = 0.005
)"},
                                         {"monte_carlo", R"(
[[body]]
name = "ring"
shape = "ring"
radius = 0.3
points_on_ring = 6
count = 2
[integrator]
name = "monte-carlo"
dt = 0.005
)"}};

Config case_of(const RankedRun& run) {
  const std::string label = run.label;
  std::string text = ranked_fluid;
  if (label == "sheared_with_mass" || label == "setd" || label == "velocity_verlet" ||
      label == "shardlow")
    text += "mass = 0.2\n";
  const std::string tables = run.text;
  if (tables.find("[box]") == std::string::npos) text += ranked_box;
  return Config::from_text(text + tables + ranked_end, label);
}

struct Ran {
  odpd::Results results;
  odpd::Frame frame;
  odpd::SolverStatistics statistics;
  std::string summary;
};

Ran run_of(const Config& config, const Communicator& ranks) {
  odpd::Simulation<2> simulation(config, odpd::read_case(config, "ranks"), {}, nullptr, ranks);
  simulation.run([] { return false; }, [] {});
  return {simulation.results(), simulation.frame(), simulation.dynamics().statistics(),
          simulation.integrator().summary()};
}

// Equal, or both undefined.
void expect_same(double a, double b, double error, const std::string& what) {
  if (std::isnan(a) && std::isnan(b)) return;
  EXPECT_NEAR(a, b, error) << what;
}

class RankedRuns : public testing::TestWithParam<RankedRun> {};

INSTANTIATE_TEST_SUITE_P(All, RankedRuns, testing::ValuesIn(ranked_runs),
                         [](const auto& test) { return test.param.label; });

TEST_P(RankedRuns, GiveWhatOneRankGives) {
  odpd::set_threads(1, 0);
  const Ran one = run_of(case_of(GetParam()), Communicator::alone());
  for (const int size : {2, 4}) {
    const std::vector<Ran> several = contract::on_ranks(
        size, [](const Communicator& ranks) { return run_of(case_of(GetParam()), ranks); });
    const Ran& first = several.front();
    for (const Ran& ran : several) {
      EXPECT_EQ(ran.frame.position, first.frame.position) << "ranks differ";
      EXPECT_EQ(ran.statistics.iterations, first.statistics.iterations);
      EXPECT_EQ(ran.summary, one.summary);
      ASSERT_EQ(ran.results.scalars.size(), one.results.scalars.size());
      for (std::size_t k = 0; k < one.results.scalars.size(); ++k) {
        const odpd::Scalar &a = ran.results.scalars[k], &b = first.results.scalars[k],
                           &c = one.results.scalars[k];
        EXPECT_EQ(a.name, c.name);
        expect_same(a.mean, b.mean, 0.0, a.name + ": ranks differ");
        // Rounding, grown over twenty steps.
        expect_same(a.mean, c.mean, 1e-6 * (1.0 + std::abs(c.mean)), a.name);
        if (c.has_error)
          expect_same(a.standard_error, c.standard_error, 1e-5 * (1.0 + std::abs(c.mean)),
                      a.name + ", error");
      }
      ASSERT_EQ(ran.results.tables.size(), one.results.tables.size());
      for (std::size_t t = 0; t < one.results.tables.size(); ++t) {
        const auto &a = ran.results.tables[t].second.rows, &c = one.results.tables[t].second.rows;
        ASSERT_EQ(a.size(), c.size());
        for (std::size_t r = 0; r < a.size(); ++r)
          for (std::size_t k = 0; k < a[r].size(); ++k)
            expect_same(a[r][k], c[r][k], 1e-5 * (1.0 + std::abs(c[r][k])),
                        one.results.tables[t].first);
      }
    }
    ASSERT_EQ(first.frame.position.size(), one.frame.position.size());
    for (std::size_t k = 0; k < one.frame.position.size(); ++k)
      EXPECT_NEAR(first.frame.position[k], one.frame.position[k], 1e-7);
  }
}

std::string end_of(const std::string& box, const Communicator& ranks) {
  const Config config = Config::from_text(
      ranked_fluid + box + "[integrator]\ndt = 0.5\n[run]\nduration = 100.0\n", "hot");
  try {
    run_of(config, ranks);
  } catch (const odpd::SolverError& e) {
    return e.what();
  }
  return "it did not blow up";
}

// A run that blows up says so on all ranks, as one rank does; also where the first of them has walls alone, and nobody free who
// might be the fastest.
TEST(RankedRun, BlowsUpTogether) {
  odpd::set_threads(1, 0);
  for (const std::string& box : {ranked_box, std::string(R"(
[box]
size = [5.0, 6.0]
periodic = [true, false]
[[wall]]
side = "y-"
layers = [{ depth = 0.5, count = 200 }]
[[wall]]
side = "y+"
layers = [{ depth = 0.5, count = 200 }]
)")}) {
    const std::string one = end_of(box, Communicator::alone());
    EXPECT_NE(one.find("blown up"), std::string::npos) << one;
    for (const int size : {2, 4}) {
      const std::vector<std::string> several =
          contract::on_ranks(size, [&](const Communicator& ranks) { return end_of(box, ranks); });
      for (const std::string& message : several) EXPECT_EQ(message, several.front());
      // Beyond the first steps of such a run rounding decides how it ends.
      EXPECT_NE(several.front().find("blown up"), std::string::npos) << several.front();
    }
  }
}

TEST(RankedRun, StopsTogether) {
  odpd::set_threads(1, 0);
  const auto stopped = [&](const Communicator& ranks) {
    const Config config = case_of(ranked_runs[4]);
    odpd::Simulation<2> simulation(config, odpd::read_case(config, "ranks"), {}, nullptr, ranks);
    int asked = 0;
    simulation.run([&] { return ranks.rank() == 1 && ++asked > 3; }, [] {});
    return simulation.clock().step;
  };
  for (const std::int64_t step : contract::on_ranks(2, stopped)) EXPECT_EQ(step, 3);
}

}  // namespace
