#pragma once
// What a solve will cost, from the smaller sizes of the same backend that were measured.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "backends.h"
#include "results.h"

namespace bench {

struct Prediction {
  double seconds = 0.0;   ///< set-up and solve; 0: nothing to go by
  double bytes = 0.0;     ///< of the backend
  std::string objection;  ///< the next smaller size was already skipped or failed
};

/// seconds ~ N^p with p measured between the two largest sizes below N (at least 1), or the backend's own exponent where
/// there is only one; bytes likewise.
Prediction predict(const Results& solves, const Backend& backend, int dimension,
                   const std::string& geometry, double tolerance, std::int64_t particles);

/// Columns of results.csv behind its key.
inline constexpr std::array measured_columns{"status",
                                             "iterations",
                                             "rebuild_s",
                                             "setup_s",
                                             "assembly_s",
                                             "rebind_s",
                                             "solve_s",
                                             "residual",
                                             "error",
                                             "bytes_per_particle",
                                             "peak_bytes_per_particle",
                                             "repeats",
                                             "triad_GB_s",
                                             "note"};

/// A row solved with the same key but for the tolerance; size() where there is none.
std::size_t solved_twin(const Results& solves, const std::vector<std::string>& key);

}  // namespace bench
