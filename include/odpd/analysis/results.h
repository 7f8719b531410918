#pragma once
// What observers give at the end of a run: numbers with errors, tables and charts.
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "odpd/core/table.h"

namespace odpd {

/// A measured number; NaN: undefined. `standard_error` is NaN while there are too few independent blocks for one.
struct Scalar {
  std::string name;
  double mean = std::numeric_limits<double>::quiet_NaN();
  double standard_error = std::numeric_limits<double>::quiet_NaN();
  /// False: it never has a standard error, as a count or the largest of many.
  bool has_error = true;
};

/// One of the latter.
inline Scalar without_error(std::string name, double value,
                            double standard_error = std::numeric_limits<double>::quiet_NaN()) {
  return {std::move(name), value, standard_error, false};
}

struct Results {
  std::vector<Scalar> scalars;
  std::vector<std::pair<std::string, Table>> tables;  ///< file stem, table
  std::vector<std::pair<std::string, Chart>> charts;  ///< file stem, chart
  std::vector<std::string> notes;                     ///< choices a reader must know of

  const Scalar* find(const std::string& name) const {
    for (const Scalar& s : scalars)
      if (s.name == name) return &s;
    return nullptr;
  }
  /// Empty where `name` is among the scalars, else that it is not, with the nearest one and those that there are.
  std::string objection(const std::string& name) const;
};

}  // namespace odpd
