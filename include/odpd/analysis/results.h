#pragma once
// What observers give at the end of a run: numbers with errors, tables and charts.
#include <string>
#include <utility>
#include <vector>

#include "odpd/core/table.h"

namespace odpd {

/// A measured number. `standard_error` is NaN while there are too few independent blocks for one.
struct Scalar {
  std::string name;
  double mean = 0.0;
  double standard_error = 0.0;
};

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
};

}  // namespace odpd
