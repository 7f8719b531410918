#pragma once
// The solvers that are compared, and one cold solve by each.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "configuration.h"
#include "odpd/solvers/solver.h"

namespace bench {

struct Backend {
  std::string name;             ///< in tables
  odpd::SolverOptions options;  ///< but the tolerance
  bool direct = false;          ///< one factorisation serves all tolerances
  bool rotations = false;       ///< told the rigid-body rotations although the box is periodic
  double growth_2d = 1.5;       ///< exponent of seconds in N before two sizes were measured
  double growth_3d = 1.35;
  double memory_growth = 1.0;  ///< of bytes in N, likewise
};

/// odpd's own first.
const std::vector<Backend>& backends();
/// Those that are odpd's own: `pcg`, with which the others are compared, first; the plainest (block-Jacobi) last.
std::vector<Backend> own_backends();
bool available(const Backend& backend);

/// The best of `repeats` solves by a solver made anew each time. Seconds.
struct Measured {
  odpd::SolveReport report;
  double rebuild = 0.0;   ///< of the operator, common to all backends
  double setup = 0.0;     ///< bind, assembly included
  double assembly = 0.0;  ///< the part of it that assembles and copies a matrix
  double rebind = 0.0;    ///< the same solver bound again to an operator rebuilt; NaN: not measured
  double solve = 0.0;
  double peak_bytes = 0.0;  ///< by which the process grew at most in set-up and solve; NaN: unknown
  int repeats = 0;
  std::vector<double> x;

  double total() const { return setup + solve; }
};

/// Repeats up to five times while all together take less than 1.5 s. Throws what the solver throws.
template <int D>
Measured measure(Problem<D>& problem, const Backend& backend, double tolerance);

}  // namespace bench
