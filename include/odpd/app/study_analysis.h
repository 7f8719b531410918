#pragma once
// From runs to findings. For one point and one observable:
//
//   value      mean over seeds; its standard error from those of the runs, with three or more seeds the larger of that
//              and the scatter between seeds
//   bias       value - reference, standard error sigma from both
//   error      |bias| / |reference| (|bias| where the reference is 0, and of a table, whose value is the rms difference)
//   cost       seconds of the steps per unit of simulated time
#include <string>
#include <vector>

#include "odpd/app/study_run.h"

namespace odpd {

/// A number with its standard error (NaN: undefined).
struct Estimate {
  double mean = 0.0;
  double standard_error = 0.0;
};

/// Of independent runs of the same point. NaN of none.
Estimate averaged(const std::vector<Estimate>& runs);

/// failed: ended with an error that was no blow-up.
enum class Verdict { ok, biased, unclear, blew_up, failed, missing };
const char* verdict_name(Verdict verdict);

/// Of a relative bias with standard error sigma. Unclear: the runs are too short to tell a bias of `tolerance` from none
/// (2 sigma > tolerance and |bias| <= 2 sigma, or sigma undefined).
Verdict classify(double bias, double sigma, double tolerance);

/// Indices of the points that no other point beats (as accurate and cheaper, or as cheap and more accurate), by rising
/// cost. Points with NaN in them do not compete.
std::vector<std::size_t> pareto_front(const std::vector<double>& cost,
                                      const std::vector<double>& error);

struct Finding {
  std::size_t point = 0, observable = 0;
  int seeds = 0;  ///< runs that gave a value
  Estimate value, reference;
  double bias = 0.0, sigma = 0.0;  ///< relative, as said above; NaN where there is no value
  bool is_reference = false;       ///< the point is its own reference
  bool below_noise = false;        ///< |bias| < 2 sigma
  bool on_front = false;
  Verdict verdict = Verdict::missing;
  bool out_of_time = false;   ///< some run was stopped by the limit of seconds
  double cost = 0.0;          ///< s per time unit
  double wall_seconds = 0.0;  ///< of all its runs
  double blew_up_at = 0.0;    ///< the earliest end with an error; NaN where there was none
  std::string failure;        ///< of the run that blew up or failed (RunOutcome)
  std::string message;

  bool ended_with_error() const {
    return verdict == Verdict::blew_up || verdict == Verdict::failed;
  }
  /// In words: of a failure what kind it was.
  std::string verdict_text() const { return ended_with_error() ? failure : verdict_name(verdict); }

  /// What the chart shows as the error: |bias|, below the noise its upper limit 2 sigma.
  double shown_error() const;
};

/// "<name>.rms" is a number where any run gives one of that name, else of a table: then `table` stays.
void tell_numbers_from_tables(StudySettings& study,
                              const std::vector<std::vector<RunOutcome>>& outcomes);

/// All findings, observable by observable in the order of the points, without the Monte Carlo points. `outcomes` has
/// [point][run] of the plan; tables are read from `directory`/<run>/run. A front is drawn for each combination of the
/// axes beside method and sweep.
std::vector<Finding> findings(const StudySettings& study, const StudyPlan& plan,
                              const std::vector<std::vector<RunOutcome>>& outcomes,
                              const std::filesystem::path& directory);

/// Two points belong to one chart: they differ along method and sweep alone.
bool same_chart(const StudySettings& study, const StudyPoint& a, const StudyPoint& b);

}  // namespace odpd
