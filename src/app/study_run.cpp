#include "odpd/app/study_run.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <sstream>
#include <system_error>
#include <thread>

#include "odpd/app/info.h"
#include "odpd/app/interrupt.h"
#include "odpd/app/report.h"
#include "odpd/core/error.h"
#include "odpd/core/timer.h"
#include "odpd/io/file.h"
#include "odpd/io/json.h"

extern char** environ;

namespace odpd {

namespace {

namespace fs = std::filesystem;

const char* word(RunStatus status) {
  switch (status) {
    case RunStatus::done:
      return "done";
    case RunStatus::out_of_time:
      return "out of time";
    case RunStatus::blew_up:
      return "blew up";
    case RunStatus::failed:
      return "failed";
    case RunStatus::missing:
      break;
  }
  return "missing";
}

// Starts the program with its output in log.txt, in a process group of its own: Ctrl-C comes to the study, which
// passes it on once.
pid_t start(const std::vector<std::string>& words, const fs::path& log) {
  std::vector<char*> arguments;
  for (const std::string& w : words) arguments.push_back(const_cast<char*>(w.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  pid_t child = -1;
  const int error = ::posix_spawn(&child, words.front().c_str(), &actions, &attributes,
                                  arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0)
    throw IoError(fmt::format("{}: cannot be started with its output in {}: {}; check permissions",
                              words.front(), log.string(), std::generic_category().message(error)));
  return child;
}

struct Ended {
  int status = 0;  ///< of the process
  bool out_of_time = false;
  double share = 1.0;  ///< of the wall time that it had a processor
};

double seconds_of(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

// Waits; asks the child once to stop when the user does or the time is up.
Ended wait_for(pid_t child, double limit) {
  Ended ended;
  const Stopwatch watch;
  bool asked = false;
  while (true) {
    rusage usage{};
    const pid_t got = ::wait4(child, &ended.status, WNOHANG, &usage);
    if (got == child) {
      const double used = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
      ended.share = std::min(1.0, used / std::max(watch.seconds(), 1e-9));
      break;
    }
    if (got < 0 && errno != EINTR)
      throw IoError(
          fmt::format("a point's process is lost: {}", std::generic_category().message(errno)));
    ended.out_of_time = limit > 0.0 && watch.seconds() > limit;
    if (!asked && (ended.out_of_time || interrupted())) {
      ::kill(child, SIGINT);
      asked = true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return ended;
}

// The text behind "odpd: error: " in the log.
std::string last_error(const fs::path& log) {
  std::istringstream lines(read_file(log));
  const std::string mark = "odpd: error: ";
  std::string message;
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(mark)) message = line.substr(mark.size());
  return message;
}

// "step 123: ..." is how the program tells when a run broke.
double time_of(const std::string& message, double dt) {
  std::int64_t step = 0;
  return std::sscanf(message.c_str(), "step %ld", &step) == 1 ? static_cast<double>(step) * dt
                                                              : std::nan("");
}

// A run that was stopped while it started has none. Seconds of stepping count by the share of a processor that the run
// had: others on the machine do not make it slow.
void read_summary(const fs::path& file, double share, RunOutcome& outcome) {
  std::error_code ignored;
  if (outcome.status == RunStatus::out_of_time && !fs::exists(file, ignored)) return;
  const JsonDocument summary(file);
  outcome.time = summary.number({"time"});
  outcome.wall_seconds = summary.number({"wall_seconds"});
  outcome.step_seconds = 0.0;
  for (const std::string& phase : summary.keys({"phase_seconds"}))
    if (phase != "write" && phase != "measure")
      outcome.step_seconds += share * summary.number({"phase_seconds", phase});
  for (const std::string& name : summary.keys({"observables"}))
    outcome.observables.push_back({name, summary.number({"observables", name, "mean"}),
                                   summary.number({"observables", name, "stderr"})});
}

// What kind of error ended a run. Its summary tells, where the run came so far that it wrote one.
void read_failure(const fs::path& summary, const std::string& message, RunOutcome& outcome) {
  outcome.failure = cause_name(SolverError::Cause::other);
  std::error_code ignored;
  if (message.starts_with("not enough memory")) {
    outcome.failure = "out of memory";
  } else if (fs::exists(summary, ignored)) {
    const JsonDocument json(summary);
    for (const char* key : {"blew_up", "failed"})
      if (const std::string cause = json.text({key, "cause"}); !cause.empty())
        outcome.failure = cause;
  }
  const bool blew_up = outcome.failure == cause_name(SolverError::Cause::blow_up);
  outcome.status = blew_up ? RunStatus::blew_up : RunStatus::failed;
}

void write_outcome(const fs::path& file, const RunOutcome& outcome, double limit) {
  JsonObject json;
  json.set("status", word(outcome.status))
      .set("failure", outcome.failure)
      .set("message", outcome.message)
      .set("time", outcome.time);
  json.set("program", build_identity())
      .set("seconds_limit", limit)
      .set("processor_share", outcome.processor_share);
  write_file_atomically(file, json.text() + "\n");
}

bool is_same_case(const fs::path& directory, const StudyRun& run) {
  std::error_code ignored;
  return fs::is_regular_file(directory / "case.toml", ignored) &&
         read_file(directory / "case.toml") == run.resolved;
}

}  // namespace

const RunOutcome::Number* RunOutcome::find(const std::string& name) const {
  for (const Number& number : observables)
    if (number.name == name) return &number;
  return nullptr;
}

RunOutcome earlier_outcome(const StudyExecution& execution, const StudyRun& run) {
  const fs::path directory = execution.directory / run.name;
  RunOutcome outcome;
  std::error_code ignored;
  if (!is_same_case(directory, run) || !fs::exists(directory / "outcome.json", ignored))
    return outcome;
  const JsonDocument json(directory / "outcome.json");
  for (const RunStatus status :
       {RunStatus::done, RunStatus::out_of_time, RunStatus::blew_up, RunStatus::failed})
    if (json.text({"status"}) == word(status)) outcome.status = status;
  // With more time, or no limit, it goes on.
  const bool may_go_on =
      execution.seconds == 0.0 || execution.seconds > json.number({"seconds_limit"});
  if (outcome.status == RunStatus::out_of_time && may_go_on) return {};
  outcome.failure = json.text({"failure"});
  outcome.message = json.text({"message"});
  outcome.time = json.number({"time"});
  if (!outcome.ended_with_error())
    read_summary(directory / "run" / "summary.json", json.number({"processor_share"}), outcome);
  return outcome;
}

RunOutcome execute(const StudyExecution& execution, const StudyRun& run) {
  const fs::path directory = execution.directory / run.name, log = directory / "log.txt";
  const fs::path checkpoint = directory / "run" / "checkpoint.h5";
  std::error_code ignored;
  const bool continues = is_same_case(directory, run) && fs::exists(checkpoint, ignored);
  make_directory(directory);
  fs::remove(directory / "outcome.json", ignored);
  write_file_atomically(directory / "case.toml", run.resolved);
  std::vector<std::string> words{execution.program.string(),
                                 "run",
                                 (directory / "case.toml").string(),
                                 "--quiet",
                                 "--threads",
                                 std::to_string(execution.threads)};
  if (continues) {
    words.insert(words.end(), {"--restart", checkpoint.string()});
  } else {
    words.insert(words.end(), {"--out", (directory / "run").string()});
  }
  const Ended ended = wait_for(start(words, log), execution.seconds);
  RunOutcome outcome;
  const int code = WIFEXITED(ended.status) ? WEXITSTATUS(ended.status) : -1;
  const std::string message = last_error(log);
  const bool stopped = code == 130 || (code < 0 && WTERMSIG(ended.status) == SIGINT);
  if (code == 1) throw ConfigError(fmt::format("the point {}: {}", run.name, message));
  if (code == 3) throw IoError(fmt::format("the point {}: {}", run.name, message));
  if (stopped && !ended.out_of_time) return outcome;
  if (code == 0 || code == 4 || stopped) {
    outcome.status = stopped ? RunStatus::out_of_time : RunStatus::done;
    outcome.processor_share = ended.share;
    read_summary(directory / "run" / "summary.json", ended.share, outcome);
  } else {
    read_failure(directory / "run" / "summary.json", message, outcome);
    outcome.message =
        !message.empty() ? message
        : code >= 0      ? fmt::format("the program ended with code {}", code)
                    : fmt::format("the program was ended by signal {}", WTERMSIG(ended.status));
    outcome.time = time_of(message, run.dt);
  }
  // What ended for want of memory, or was killed, gets another chance next time.
  if (!outcome.ended_with_error() || (code == 2 && outcome.failure != "out of memory"))
    write_outcome(directory / "outcome.json", outcome, execution.seconds);
  return outcome;
}

}  // namespace odpd
