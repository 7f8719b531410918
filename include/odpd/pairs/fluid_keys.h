#pragma once
// What the reader of a pair model gets: the tables of the case that are the model's, and what else its numbers may depend on.
#include <cstddef>
#include <vector>

#include "odpd/core/config.h"
#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/pairs/calibration.h"

namespace odpd {

struct FluidKeys {
  /// A [[pair]], less its key `species`: the species a and b by index.
  struct Pair {
    Config keys;
    std::size_t a, b;
  };

  /// [fluid], less the keys that are of every model (density, count, mass, zeta_0, ...).
  Config fluid;
  std::vector<Pair> pairs;
  std::size_t species = 1;  ///< how many
  double density = 0.0;  ///< of the fluid's particles (1/length^d); 0: a start file tells it later
  /// Of bodies and molecules, where [fluid] tells a number and not a density. What fills space has room for all together.
  double others = 0.0;
  double mass = 0.0;
  /// Contents of the file that fluid.calibration names, where it was read.
  std::optional<Calibration> calibration;
};

/// A table [A * species + B] of the parameters of all pairs of species: those of [fluid], and what read(keys, fluid) makes of them for a
/// [[pair]].
template <class Parameters, class Read>
std::vector<Parameters> pair_table(const FluidKeys& f, const Parameters& fluid, const Read& read) {
  std::vector<Parameters> table(f.species * f.species, fluid);
  for (const FluidKeys::Pair& pair : f.pairs)
    table[pair.a * f.species + pair.b] = table[pair.b * f.species + pair.a] =
        read(pair.keys, fluid);
  return table;
}

/// Throws ConfigError unless such a table has all pairs of species, and those of A with B are those of B with A: forces must not depend
/// on which of two particles comes first.
template <class Parameters>
void require_pair_table(int species, const std::vector<Parameters>& table) {
  const std::size_t n = index(species);
  if (table.size() != n * n)
    throw ConfigError("parameters of " + std::to_string(table.size()) +
                      " pairs of species are given, " + std::to_string(n) + " species have " +
                      std::to_string(n * n));
  for (std::size_t a = 0; a < n; ++a)
    for (std::size_t b = 0; b < a; ++b)
      if (table[a * n + b] != table[b * n + a])
        throw ConfigError("parameters of species " + std::to_string(a) + " with " +
                          std::to_string(b) + " must be those of " + std::to_string(b) + " with " +
                          std::to_string(a));
}

}  // namespace odpd
