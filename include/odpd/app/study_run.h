#pragma once
// Runs of a study, each as a process of its own, so that nothing a point does ends the study. A run's directory holds
//
//   case.toml      the case as planned           outcome.json   how it ended, written last
//   log.txt        what the program said         run/           the files of the run
//
// A run whose planned case is the same and which has an outcome is not run again; one that was stopped continues from
// its checkpoint.
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "odpd/app/study_plan.h"

namespace odpd {

/// blew_up and failed: ended with an error.
enum class RunStatus { missing, done, out_of_time, blew_up, failed };

/// How a run ended and what it gave.
struct RunOutcome {
  RunStatus status = RunStatus::missing;
  std::string failure;        ///< "blew up", "not converged", "singular", "out of memory", "failed"
  std::string message;        ///< of a run that ended with an error, in the program's words
  double time = 0.0;          ///< simulated, equilibration included; of an error: when it came
  double wall_seconds = 0.0;  ///< of the whole run; not known of a blow-up
  double step_seconds =
      0.0;  ///< of the steps alone, without measuring and writing, while it had a processor
  double processor_share = 1.0;  ///< of the wall time of its last part that the run had a processor
  struct Number {
    std::string name;
    double mean = 0.0, standard_error = 0.0;
  };
  std::vector<Number> observables;

  const Number* find(const std::string& name) const;
  bool ended_with_error() const {
    return status == RunStatus::blew_up || status == RunStatus::failed;
  }
};

struct StudyExecution {
  std::filesystem::path program = "/proc/self/exe";
  std::filesystem::path directory;  ///< <out>/points
  int threads = 1;
  double seconds = 0.0;  ///< limit of wall time for a run; 0: none
};

/// What is there of an earlier execution of the same planned case; status `missing` when nothing is.
RunOutcome earlier_outcome(const StudyExecution& execution, const StudyRun& run);
/// Runs it, or what is left of it. Interrupted by the user: the status is `missing`. Throws ConfigError and IoError with
/// the program's message when a case is wrong or a file cannot be written.
RunOutcome execute(const StudyExecution& execution, const StudyRun& run);

}  // namespace odpd
