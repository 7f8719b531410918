#include "gnuplot_run.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <mutex>
#include <optional>
#include <string_view>
#include <system_error>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/log.h"
#include "odpd/io/file.h"

extern char** environ;

namespace odpd {

namespace fs = std::filesystem;

namespace {

struct Outcome {
  int status = 0;        ///< of waitpid
  std::string messages;  ///< what it wrote to stderr
};

/// The last part of what gnuplot wrote: it names the error at the end.
std::string last_lines(const std::string& messages) {
  constexpr std::size_t most = 400;
  std::string text = messages.size() > most ? messages.substr(messages.size() - most) : messages;
  std::replace(text.begin(), text.end(), '\n', ' ');
  const auto first = text.find_first_not_of(' ');
  if (first == std::string::npos) return "no message";
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

std::string read_pipe(int number) {
  std::string text;
  std::array<char, 4096> buffer{};
  while (true) {
    const ssize_t count = ::read(number, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(buffer.data(), index(count));
  }
}

/// Starts gnuplot without a shell; an errno value when that fails, 0 otherwise.
int spawn_gnuplot(const fs::path& directory, std::string script, int messages, pid_t& child) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, directory.c_str());
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, messages, STDERR_FILENO);
  // -d: the user's own gnuplot defaults do not change our pictures.
  std::string program = "gnuplot", defaults = "-d";
  std::array<char*, 4> arguments{program.data(), defaults.data(), script.data(), nullptr};
  const int error =
      ::posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

/// Runs gnuplot on a script in `directory`; nothing when there is no gnuplot.
std::optional<Outcome> execute(const fs::path& directory, const std::string& script) {
  std::array<int, 2> pipe_ends{};
  if (::pipe2(pipe_ends.data(), O_CLOEXEC) != 0) {
    throw IoError(fmt::format("gnuplot cannot be started: {}; close other programs",
                              std::generic_category().message(errno)));
  }
  pid_t child = -1;
  const int error = spawn_gnuplot(directory, script, pipe_ends[1], child);
  ::close(pipe_ends[1]);
  Outcome outcome;
  if (error == 0) outcome.messages = read_pipe(pipe_ends[0]);
  ::close(pipe_ends[0]);
  if (error == ENOENT || error == EACCES) return {};
  if (error != 0) {
    throw IoError(fmt::format("gnuplot cannot be started: {}; close other programs",
                              std::generic_category().message(error)));
  }
  while (::waitpid(child, &outcome.status, 0) < 0) {
    if (errno == EINTR) continue;
    outcome.status = -1;
    break;
  }
  return outcome;
}

void warn_of_missing_gnuplot() {
  static std::once_flag warned;
  std::call_once(warned, [] {
    log_warning(
        "gnuplot is not installed: no pictures are made; install it and run gnuplot on the .gp "
        "files that are written instead");
  });
}

/// A picture is whole when its last bytes are there: gnuplot does not notice a full disk.
bool is_whole(const fs::path& file, std::string_view mark) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return false;
  const std::string bytes = read_file(file);
  const std::size_t tail = std::min<std::size_t>(bytes.size(), 16);
  return std::string_view(bytes).substr(bytes.size() - tail).find(mark) != std::string_view::npos;
}

}  // namespace

std::string gnuplot_quoted(const std::string& text) {
  std::string result = "'";
  for (const char letter : text) {
    if (letter == '\'') result += '\'';
    result += letter == '\n' || letter == '\r' ? ' ' : letter;
  }
  return result + "'";
}

std::string gnuplot_outputs(const std::string& name, const std::string& plot, int width,
                            int height) {
  return fmt::format(
      "set encoding utf8\n"
      "pixel = 1/6.75\n"
      "set terminal svg size {0},{1} font 'Helvetica,18' background '#ffffff'\n"
      "set output {2}\n"
      "{4}\n"
      "pixel = 1/3.0\n"
      "if (strstrt(GPVAL_TERMINALS, 'pngcairo') > 0) {{\n"
      "  set terminal pngcairo size {0},{1} font 'Helvetica,14'\n"
      "}} else {{\n"
      "  set terminal png size {0},{1} font ',14'\n"
      "}}\n"
      "set output {3}\n"
      "replot\n"
      "set output\n",
      width, height, gnuplot_quoted(name + ".svg"), gnuplot_quoted(name + ".png"), plot);
}

bool run_gnuplot(const fs::path& stem, const std::string& script) {
  const fs::path directory = stem.has_parent_path() ? stem.parent_path() : fs::path(".");
  const std::string name = stem.filename().string();
  write_file_atomically(directory / (name + ".gp"), script);
  const fs::path vector_picture = directory / (name + ".svg");
  const fs::path pixel_picture = directory / (name + ".png");
  std::error_code ignored;  // older pictures must not pass for new ones
  fs::remove(vector_picture, ignored);
  fs::remove(pixel_picture, ignored);
  const auto outcome = execute(directory, "./" + name + ".gp");
  if (!outcome) {
    warn_of_missing_gnuplot();
    return false;
  }
  if (!WIFEXITED(outcome->status) || WEXITSTATUS(outcome->status) != 0) {
    throw IoError(fmt::format("{}.gp: gnuplot failed: {}; run it by hand to see more",
                              stem.string(), last_lines(outcome->messages)));
  }
  for (const auto& [file, mark] :
       {std::pair(vector_picture, "</svg>"), std::pair(pixel_picture, "IEND")}) {
    if (is_whole(file, mark)) continue;
    throw IoError(
        fmt::format("{}: was not written whole by gnuplot: {}; free some space, or "
                    "choose another --out",
                    file.string(), last_lines(outcome->messages)));
  }
  return true;
}

}  // namespace odpd
