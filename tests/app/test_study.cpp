// What a study concludes from its runs, and which points it makes of its file.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "io/temporary_directory.h"
#include "odpd/app/study_analysis.h"
#include "odpd/app/study_report.h"
#include "odpd/core/error.h"
#include "support/errors.h"

namespace odpd {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Averaged, CombinesTheErrorsOfTwoRuns) {
  const Estimate e = averaged({{1.0, 0.3}, {2.0, 0.4}});
  EXPECT_DOUBLE_EQ(e.mean, 1.5);
  EXPECT_DOUBLE_EQ(e.standard_error, 0.25);
  EXPECT_TRUE(std::isnan(averaged({{1.0, nan}, {2.0, 0.4}}).standard_error));
  EXPECT_TRUE(std::isnan(averaged({}).mean));
}

TEST(Averaged, OfThreeOrMoreTakesTheLargerOfErrorAndScatter) {
  // Scatter: deviations -1, 0, 1, so sqrt(2/(3*2)).
  EXPECT_DOUBLE_EQ(averaged({{1.0, 0.1}, {2.0, 0.1}, {3.0, 0.1}}).standard_error,
                   std::sqrt(1.0 / 3.0));
  EXPECT_DOUBLE_EQ(averaged({{1.0, 3.0}, {2.0, 3.0}, {3.0, 3.0}}).standard_error,
                   std::sqrt(27.0) / 3.0);
  EXPECT_DOUBLE_EQ(averaged({{1.0, nan}, {2.0, 0.1}, {3.0, 0.1}}).standard_error,
                   std::sqrt(1.0 / 3.0))
      << "the scatter is known where a run's error is not";
}

TEST(Classify, TellsBiasFromNoise) {
  EXPECT_EQ(classify(0.005, 0.001, 0.01), Verdict::ok);
  EXPECT_EQ(classify(-0.02, 0.001, 0.01), Verdict::biased);
  EXPECT_EQ(classify(0.05, 0.02, 0.01), Verdict::biased) << "noisy, but far beyond the noise";
  EXPECT_EQ(classify(0.002, 0.006, 0.01), Verdict::unclear)
      << "a bias of the tolerance would go unseen";
  EXPECT_EQ(classify(0.03, 0.02, 0.01), Verdict::unclear);
  EXPECT_EQ(classify(0.5, nan, 0.01), Verdict::unclear);
  EXPECT_EQ(classify(nan, 0.1, 0.01), Verdict::missing);
}

TEST(ParetoFront, KeepsWhatNothingBeats) {
  const std::vector<double> cost{4, 1, 2, 3, 1, 5}, error{1, 9, 3, 5, 10, 1};
  EXPECT_EQ(pareto_front(cost, error), (std::vector<std::size_t>{1, 2, 0}));
  EXPECT_EQ(pareto_front({1, nan, 2}, {3, 1, nan}), (std::vector<std::size_t>{0}));
  EXPECT_TRUE(pareto_front({}, {}).empty());
  EXPECT_EQ(pareto_front({1, 1}, {2, 2}).size(), 1u) << "of two equal points one is enough";
}

class StudyFile : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& rest) {
    write_text("case.toml", R"(dimension = 2
[box]
size = [4.0, 4.0]
periodic = [true, true]
[fluid]
density = 3.0
kT = 1.0
a = 18.5
gamma = 4.5
[integrator]
dt = 0.01
[run]
duration = 0.1
[[check]]
observable = "pressure"
expected = 1.0
tolerance = 1.0
)");
    return write_text("study.toml", "case = \"case.toml\"\n" + rest);
  }
  std::filesystem::path write_text(const std::string& name, const std::string& text) {
    std::ofstream(directory_ / name) << text;
    return directory_ / name;
  }
  test::TemporaryDirectory directory_;
};

const std::string two_axes = R"(
seeds = 2
[set]
fluid.a = 20
[[axis]]
name = "method"
values = [{ label = "T", integrator.name = "trapezoidal" }, { label = "E", "integrator.name" = "euler" }]
[[axis]]
key = "integrator.dt"
values = [0.01, 0.02, 0.05]
quick = [0.050, 0.01]
[[observable]]
name = "pressure"
)";

TEST_F(StudyFile, MakesEveryCombinationWithEverySeed) {
  const StudySettings study = read_study(write(two_axes + "reference = 30\n"), false);
  const StudyPlan plan = plan_study(study, false);
  ASSERT_EQ(plan.points.size(), 6u);
  EXPECT_EQ(plan.points[4].label, "E, dt=0.02");
  ASSERT_EQ(plan.points[4].runs.size(), 2u);
  const StudyRun& run = plan.points[4].runs[1];
  EXPECT_EQ(run.overrides, (std::vector<std::string>{"fluid.a=20", "integrator.name=\"euler\"",
                                                     "integrator.dt=0.02", "seed=2"}));
  EXPECT_NE(run.resolved.find("a = 20"), std::string::npos);
  EXPECT_NE(run.resolved.find("gamma = 4.5"), std::string::npos);
  EXPECT_EQ(run.resolved.find("[[check]]"), std::string::npos)
      << "checks belong to the case as it is";
  EXPECT_EQ(run.steps, 5);
  EXPECT_NE(run.name, plan.points[4].runs[0].name);
  EXPECT_EQ(plan.reference[4][0], plan.points.size());
}

TEST_F(StudyFile, HasAQuickForm) {
  const std::string quick =
      "reference = 30\n[quick]\nseeds = 1\n[quick.budget]\nduration = 0.05\n[quick.set]\nfluid.a = "
      "10\n";
  const StudySettings study = read_study(write(two_axes + quick), true);
  const StudyPlan plan = plan_study(study, false);
  ASSERT_EQ(plan.points.size(), 4u);
  EXPECT_EQ(plan.points[0].label, "T, dt=0.05");
  EXPECT_EQ(plan.points[0].runs.size(), 1u);
  EXPECT_EQ(plan.points[0].runs[0].steps, 1);
  EXPECT_EQ(plan.points[0].runs[0].overrides.front(), "fluid.a=10");
}

TEST_F(StudyFile, LeavesOutWhatItIsToldTo) {
  const std::string skip = "reference = 30\n[[skip]]\nmethod = \"E\"\ndt = [0.02, 0.01]\n";
  const StudyPlan plan = plan_study(read_study(write(two_axes + skip), false), false);
  ASSERT_EQ(plan.points.size(), 4u);
  EXPECT_EQ(plan.points[3].label, "E, dt=0.05");
}

TEST_F(StudyFile, ComparesWithTheFinestPointOfTheSameMethod) {
  const StudyPlan plan =
      plan_study(read_study(write(two_axes + "reference = \"finest\"\n"), false), false);
  EXPECT_EQ(plan.reference[2][0], 0u);
  EXPECT_EQ(plan.reference[5][0], 3u);
}

TEST_F(StudyFile, ComparesWithTheNamedPoint) {
  const std::string named = "reference = { method = \"T\", dt = 0.02 }\n";
  const StudyPlan plan = plan_study(read_study(write(two_axes + named), false), false);
  for (const auto& reference : plan.reference) EXPECT_EQ(reference[0], 1u);
  support::expect_error<ConfigError>([&] { read_study(write(two_axes + named), true); },
                                     {"reference", "dt", "quick"});
}

TEST_F(StudyFile, NamesWhatIsWrong) {
  const auto fails = [&](const std::string& rest, std::initializer_list<const char*> words) {
    support::expect_error<ConfigError>([&] { plan_study(read_study(write(rest), false), false); },
                                       words);
  };
  const std::string good = two_axes + "reference = 30\n";
  fails("[[observable]]\nname = \"pressure\"\nreference = 1\n", {"axis"});
  fails("[[axis]]\nkey = \"integrator.dt\"\nvalues = [0.01]\n", {"observable"});
  fails(good + "[[axis]]\nkey = \"integrator.dtt\"\nvalues = [0.01]\n",
        {"study.toml", "dtt=0.01", "integrator.dtt", "did you mean 'dt'"});
  fails(good + "[[axis]]\nkey = \"fluid.a\"\nvalues = [-1]\n", {"a=-1", "fluid.a", ">= 0"});
  fails(good + "[[axis]]\nkey = \"fluid.a\"\nvalues = [1, 1.0]\n", {"twice"});
  fails(good + "[[axis]]\nkey = \"run.dt\"\nvalues = [1]\n", {"two axes 'dt'"});
  fails(good + "[[axis]]\nvalues = [1]\nname = \"b\"\n", {"values", "label"});
  fails(good + "[[axis]]\nkey = \"fluid.a\"\nvalues = [1]\nquick = [2]\n",
        {"quick", "'2'", "no value of the axis 'a'"});
  fails(good + "[[skip]]\nmethods = \"E\"\n", {"[[skip]]"});
  fails(good + "[[skip]]\nmethod = [\"T\", \"E\"]\n", {"every point"});
  fails(good + "[budgets]\nseconds = 1\n", {"budgets", "did you mean 'budget'"});
  fails(two_axes + "reference = \"monte carlo\"\n", {"reference", "monte-carlo", "finest"});
  fails(two_axes + "reference = \"finest\"\n[[skip]]\nmethod = \"E\"\ndt = 0.01\n",
        {"compared with E, dt=0.01", "[[skip]]"});
}

// ---- findings

RunOutcome gave(double mean, double error, double step_seconds) {
  RunOutcome outcome;
  outcome.status = RunStatus::done;
  outcome.time = 2.0;
  outcome.step_seconds = step_seconds;
  outcome.observables = {{"pressure", mean, error}};
  return outcome;
}

TEST_F(StudyFile, FindsBiasCostFrontAndBlowUps) {
  StudyResults results;
  results.settings = read_study(write(two_axes + "reference = 30\ntolerance = 0.01\n"), false);
  results.plan = plan_study(results.settings, false);
  RunOutcome broken;
  broken.status = RunStatus::blew_up;
  broken.time = 0.7;
  broken.failure = "blew up";
  broken.message = "step 7: over";
  results.outcomes = {{gave(30.0, 0.06, 8.0), gave(30.03, 0.06, 8.0)},  // T: 0.01, 0.02, 0.05
                      {gave(30.1, 0.01, 4.0), gave(30.1, 0.01, 4.0)},
                      {gave(33.0, 0.01, 2.0), gave(33.0, 0.01, 2.0)},
                      {gave(33.0, 0.01, 3.0), gave(33.0, 0.01, 3.0)},  // E
                      {gave(31.0, 0.01, 1.0), broken},
                      {broken, broken}};
  const auto all = findings(results.settings, results.plan, results.outcomes, directory_.path());
  results.findings = all;
  ASSERT_EQ(all.size(), 6u);
  EXPECT_EQ(all[0].verdict, Verdict::ok);
  EXPECT_TRUE(all[0].below_noise);
  EXPECT_DOUBLE_EQ(all[0].cost, 4.0);
  EXPECT_NEAR(all[0].bias, 0.0005, 1e-12);
  EXPECT_NEAR(all[0].sigma, 0.06 / std::sqrt(2.0) / 30.0, 1e-12);
  EXPECT_DOUBLE_EQ(all[0].shown_error(), 2.0 * all[0].sigma);
  EXPECT_EQ(all[2].verdict, Verdict::biased);
  EXPECT_NEAR(all[2].bias, 0.1, 1e-12);
  EXPECT_EQ(all[4].verdict, Verdict::blew_up);
  EXPECT_DOUBLE_EQ(all[4].blew_up_at, 0.7);
  EXPECT_EQ(all[5].message, "step 7: over");
  std::vector<bool> front;
  for (const Finding& f : all) front.push_back(f.on_front);
  EXPECT_EQ(front, (std::vector<bool>{true, true, true, false, false, false}));

  const std::vector<StudyPicture> pictures = study_pictures(results);
  ASSERT_EQ(pictures.size(), 2u);
  const Chart& chart = pictures[0].chart;
  ASSERT_EQ(chart.curves.size(), 3u);
  EXPECT_EQ(chart.curves[0].label, (std::vector<std::string>{"0.05", "0.02", "0.01"}));
  EXPECT_EQ(chart.curves[1].limit, (std::vector<bool>{true, false, false}));
  EXPECT_EQ(chart.curves[2].title, "E (2 blew up)");
  const auto& rows =
      pictures[1].map.panels.at(0).rows;  // methods are the rows, from above, dt the columns
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[1][2].text, "+10.0 %");
  EXPECT_EQ(rows[0][1].text, "t = 0.7");
  EXPECT_NE(findings_csv(results).find("E,0.02,pressure,blew up,1,31,"), std::string::npos);
  const std::string page = study_page(results, pictures, {"<?xml?><svg id=\"a\"></svg>", ""});
  EXPECT_NE(page.find("<svg id=\"p0_a\">"), std::string::npos);
  EXPECT_NE(page.find("--set integrator.dt=0.02 --set seed=2"), std::string::npos);
  EXPECT_EQ(page.find("<script"), std::string::npos);
}

}  // namespace
}  // namespace odpd
