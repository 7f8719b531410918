#pragma once
// Ctrl-C and kill: the first asks the run to end after the step at hand, the second ends the process at once.
#include "odpd/core/timer.h"

namespace odpd {

/// Installs the handlers for SIGINT and SIGTERM: call where something asks `interrupted()`.
void catch_signals();
/// A write beyond a file-size limit then fails, with a message, instead of killing the program.
void let_large_writes_fail();
/// True once a signal has come.
bool interrupted();

/// When measurements are to end early: once interrupted, or after some seconds from when this was made.
class EarlyEnd {
 public:
  explicit EarlyEnd(double limit_seconds) : limit_(limit_seconds) {}  ///< 0: no limit
  bool operator()() const { return interrupted() || (limit_ > 0.0 && watch_.seconds() > limit_); }

 private:
  double limit_;
  Stopwatch watch_;
};

}  // namespace odpd
