// Solves [2 1; 1 3] x = [3; 5], x = (0.8, 1.4), with the installed library.
#include <array>
#include <cmath>
#include <cstdio>

#include "odpd/solvers/solver.h"

int main() {
  const odpd::AssembledSystem system(
      {.block = 1, .rows = 2, .start = {0, 2, 4}, .column = {0, 1, 0, 1}, .value = {2, 1, 1, 3}});
  const auto solver = odpd::make_solver({.name = "pcg", .tolerance = 1e-12});
  const std::array b = {3.0, 5.0};
  std::array x = {0.0, 0.0};
  solver->bind(system);
  const bool converged = solver->solve(b, x).converged;
  std::printf("consumer: x = (%g, %g)\n", x[0], x[1]);
  return converged && std::abs(x[0] - 0.8) < 1e-9 && std::abs(x[1] - 1.4) < 1e-9 ? 0 : 1;
}
