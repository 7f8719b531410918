// How runs of a study end, as their processes tell it. Scripts stand for the program.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "io/temporary_directory.h"
#include "odpd/app/info.h"
#include "odpd/app/study_analysis.h"
#include "odpd/app/study_run.h"
#include "odpd/io/file.h"

namespace odpd {
namespace {

namespace fs = std::filesystem;

class StudyRuns : public testing::Test {
 protected:
  StudyRuns() {
    run_.name = "point";
    run_.resolved = "seed = 1\n";
    run_.dt = 0.5;
    execution_.directory = directory_.path() / "points";
  }
  /// What comes of a program that writes a summary and a last line, and ends with a code.
  RunOutcome ended(const std::string& summary, const std::string& message, int code) {
    const fs::path program = directory_.path() / "program";
    std::ofstream(program) << "#!/bin/sh\nout=" << (execution_.directory / "point/run").string()
                           << "\nrm -rf $out; mkdir -p $out\n"
                           << (summary.empty() ? "" : "echo '" + summary + "' >$out/summary.json\n")
                           << "echo 'odpd: error: " << message << "' >&2\nexit " << code << "\n";
    fs::permissions(program, fs::perms::owner_all);
    execution_.program = program;
    return execute(execution_, run_);
  }
  test::TemporaryDirectory directory_;
  StudyRun run_;
  StudyExecution execution_;
};

TEST_F(StudyRuns, TellBlowUpsFromOtherFailures) {
  const auto summary = [](const char* key, const char* cause) {
    return std::string("{\"") + key + "\": {\"step\": 4, \"cause\": \"" + cause + "\"}}";
  };
  const RunOutcome blown = ended(summary("blew_up", "blew up"), "step 4: blown up", 2);
  EXPECT_EQ(blown.status, RunStatus::blew_up);
  EXPECT_EQ(blown.failure, "blew up");
  EXPECT_EQ(blown.time, 2.0);
  for (const char* cause : {"not converged", "singular", "failed"}) {
    const RunOutcome failed = ended(summary("failed", cause), "step 4: it ended", 2);
    EXPECT_EQ(failed.status, RunStatus::failed);
    EXPECT_EQ(failed.failure, cause);
    EXPECT_EQ(failed.message, "step 4: it ended");
    const RunOutcome again = earlier_outcome(execution_, run_);
    EXPECT_EQ(again.status, RunStatus::failed) << "it is not run again";
    EXPECT_EQ(again.failure, cause);
    EXPECT_EQ(again.message, failed.message);
  }
  EXPECT_NE(read_file(execution_.directory / "point/outcome.json").find(build_identity()),
            std::string::npos);
}

TEST_F(StudyRuns, WithoutMemoryGetAnotherChance) {
  const RunOutcome starved = ended("", "not enough memory for this case", 2);
  EXPECT_EQ(starved.status, RunStatus::failed);
  EXPECT_EQ(starved.failure, "out of memory");
  EXPECT_EQ(earlier_outcome(execution_, run_).status, RunStatus::missing);
}

TEST_F(StudyRuns, NumbersCalledRmsAreNumbers) {
  StudySettings study;
  study.observables.resize(2);
  study.observables[0].name = "divergence.rms";
  study.observables[0].table = "divergence";
  study.observables[1].name = "rdf.rms";
  study.observables[1].table = "rdf";
  RunOutcome outcome;
  outcome.observables = {{"pressure", 1.0, 0.1}, {"divergence.rms", 0.2, 0.01}};
  tell_numbers_from_tables(study, {{RunOutcome{}}, {outcome}});
  EXPECT_TRUE(study.observables[0].table.empty());
  EXPECT_EQ(study.observables[1].table, "rdf");
}

TEST(BuildIdentity, IsAHashThatStays) {
  EXPECT_EQ(build_identity().size(), 16u);
  EXPECT_EQ(build_identity().find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_EQ(build_identity(), build_identity());
  EXPECT_NE(info_text().find(build_identity()), std::string::npos);
}

}  // namespace
}  // namespace odpd
