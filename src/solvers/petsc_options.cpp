#include "odpd/solvers/petsc_options.h"

#include <algorithm>
#include <cctype>
#include <sstream>

#include "odpd/core/error.h"

namespace odpd {

namespace {

/// "-pc_type" is a name, "-1.5" a value.
bool is_name(const std::string& word) {
  return word.size() > 1 && word[0] == '-' &&
         std::isalpha(static_cast<unsigned char>(word[1])) != 0;
}

void add_name(const std::string& name, std::vector<PetscOption>& options) {
  const auto same = [&](const PetscOption& o) { return o.name == name; };
  if (std::any_of(options.begin(), options.end(), same))
    throw ConfigError("solver.petsc_options: -" + name + " is given twice: remove one");
  if (name == "ksp_rtol")
    throw ConfigError("solver.petsc_options: set solver.tolerance instead of -ksp_rtol");
  if (name == "ksp_max_it")
    throw ConfigError("solver.petsc_options: set solver.max_iterations instead of -ksp_max_it");
  options.push_back({name, ""});
}

}  // namespace

std::vector<PetscOption> parse_petsc_options(const std::string& text) {
  std::vector<PetscOption> options;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (is_name(word)) {
      add_name(word.substr(1), options);
    } else if (!options.empty() && options.back().value.empty()) {
      options.back().value = word;
    } else {
      throw ConfigError("solver.petsc_options: \"" + word +
                        "\" follows no option: write \"-name value -name value\"");
    }
  }
  return options;
}

std::string petsc_option(const std::vector<PetscOption>& options, const std::string& name,
                         const std::string& fallback) {
  const auto found = std::find_if(options.begin(), options.end(),
                                  [&](const PetscOption& o) { return o.name == name; });
  return found == options.end() ? fallback : found->value;
}

}  // namespace odpd
