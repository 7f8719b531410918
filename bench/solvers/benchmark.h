#pragma once
// The parts of the solver benchmark. Each appends rows to CSV files in `out` and skips what is there already.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "backends.h"
#include "results.h"

namespace bench {

struct Options {
  std::filesystem::path out = "build/bench";
  std::vector<std::int64_t> sizes;    ///< free particles, ascending
  std::vector<double> tolerances;     ///< descending
  int threads = 1;                    ///< of the comparison
  std::vector<int> step_threads;      ///< of triad, product and whole steps
  double limit_seconds = 0.0;         ///< a solve that is predicted to take longer is skipped
  double limit_gigabytes = 16.0;      ///< likewise for the memory of a backend
  std::vector<std::string> backends;  ///< names; empty: all
  std::string scenes;                 ///< of --robustness: a part of their names; empty: all
  bool quick = false;
  bool fresh = false;

  std::vector<Backend> chosen() const;
};

/// Everything the comparison writes.
struct Tables {
  explicit Tables(const std::filesystem::path& out);
  Results solves;    ///< results.csv
  Results products;  ///< products.csv
  Results steps;     ///< steps.csv
  Results triad;     ///< triad.csv
};

Results robustness_results(const std::filesystem::path& out);
Results ageing_results(const std::filesystem::path& out);

void run_comparison(const Options& options);
void run_robustness(const Options& options);
void run_ageing(const Options& options);
void run_suspension(const Options& options);

/// Appends the row of a backend, `key`: dimension, geometry, N. It is skipped where it is there already, or predicted to take
/// too much; else `solved` makes the cells behind `status`.
void add_solve(Results& solves, const Options& options, const Backend& backend,
               std::vector<std::string> key, double tolerance,
               const std::function<std::vector<std::string>(double tolerance)>& solved);
/// Those cells. `triad`: GB/s.
std::vector<std::string> solved_cells(const Measured& m, double error, std::int64_t particles,
                                      double triad);
/// An empty file of such rows, or what it holds.
Results solve_results(const std::filesystem::path& file);

/// table.md and the charts, from the rows there are.
void write_comparison(const Tables& tables, const std::filesystem::path& out);
void draw_comparison(const Results& solves, const std::filesystem::path& out);

/// One line on stdout, at once.
void say(const std::string& line);
/// Date, machine and version: the head of each table.
std::string table_head(const std::string& title);

}  // namespace bench
