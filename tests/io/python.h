#pragma once
// Checks of our files by foreign readers written in Python, where those are installed.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace odpd::test {

/// Exit status of the system's Python on `script` (kept in `directory`) with one argument.
inline int run_python(const std::filesystem::path& directory, const std::string& script,
                      const std::string& argument) {
  const std::filesystem::path file = directory / "check.py";
  std::ofstream(file) << script;
  const std::string command = "/usr/bin/python3 '" + file.string() + "' '" + argument + "'";
  return std::system(command.c_str());
}

inline bool python_has(const std::string& module) {
  const std::string command = "/usr/bin/python3 -c 'import " + module + "' > /dev/null 2>&1";
  return std::system(command.c_str()) == 0;
}

}  // namespace odpd::test
