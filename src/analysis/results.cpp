#include "odpd/analysis/results.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "odpd/core/config.h"

namespace odpd {

std::string Results::objection(const std::string& name) const {
  const auto stem = [](const std::string& full) { return full.substr(0, full.find('.')); };
  std::vector<std::string> names, stems, relatives;
  for (const Scalar& scalar : scalars) {
    if (scalar.name == name) return {};
    names.push_back(scalar.name);
    if (stem(scalar.name) == stem(name)) relatives.push_back(scalar.name);
    if (std::find(stems.begin(), stems.end(), stem(scalar.name)) == stems.end())
      stems.push_back(stem(scalar.name));
  }
  const std::string near = nearest_name(name, names);
  return fmt::format("nothing in this case measures '{}'{}; {}", name,
                     near.empty() ? "" : fmt::format(", did you mean '{}'?", near),
                     relatives.empty()
                         ? fmt::format("names start with one of {}", fmt::join(stems, ", "))
                         : fmt::format("there are {}", fmt::join(relatives, ", ")));
}

}  // namespace odpd
