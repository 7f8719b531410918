#pragma once
// The end of a run: what was asked, what came out, what was expected, and where the time went.
#include <optional>
#include <string>
#include <vector>

#include "odpd/analysis/results.h"
#include "odpd/app/case.h"
#include "odpd/app/simulation.h"

namespace odpd {

struct CheckOutcome {
  CheckSettings check;
  double measured = 0.0;
  double standard_error = 0.0;
  bool passed = false;
  std::string why;  ///< of a failure
};

/// A check whose observable no observer gave fails, naming those there are.
std::vector<CheckOutcome> evaluate_checks(const std::vector<CheckSettings>& checks,
                                          const Results& results, std::int64_t alarm_crossings);

/// `failure`: what ended the run, empty for none; then under "blew_up" (or "failed" with its cause, for a solver) with step
/// and time.
struct Failure {
  SolverError::Cause cause = SolverError::Cause::other;
  std::string reason;
};
/// In words: "blew up", "not converged", "singular", "failed".
const char* cause_name(SolverError::Cause cause);
template <int D>
std::string summary_json(const Simulation<D>& simulation, const Results& results,
                         const std::vector<CheckOutcome>& checks,
                         const std::optional<Failure>& failure = {});
template <int D>
std::string report_text(const Simulation<D>& simulation, const Results& results,
                        const std::vector<CheckOutcome>& checks);
/// "144 free particles, 6 in free bodies, 40 of known velocity"
template <int D>
std::string population_text(const Particles<D>& particles);
/// "1.2345 +- 0.0067": digits by the error.
std::string with_error(double value, double standard_error);

}  // namespace odpd
