#pragma once
// A fluid of two species for every row of the table of pair models (pairs/registry.cpp): what the contract of pair models is tried on.
#include <cmath>
#include <string>
#include <vector>

#include "odpd/pairs/registry.h"

namespace support {

struct ModelExample {
  std::string name;   ///< as fluid.model has it
  std::string fluid;  ///< keys of [fluid]; kT = 1 and repulsion of order 10, for density 4
  std::string pair;   ///< keys of [[pair]] for unlike particles
  odpd::ConfigValues files = {};  ///< contents of the files that keys name
};

/// A CSV of r and f(r), uneven: closer together where r is small.
template <class Function>
std::string csv_of(const std::string& header, double from, double to, const Function& f) {
  std::string text = header + "\n";
  for (int k = 0; k <= 20; ++k) {
    const double r = from + (to - from) * std::pow(k / 20.0, 1.3);
    text += std::to_string(r) + "," + std::to_string(f(r)) + "\n";
  }
  return text;
}

inline const std::vector<ModelExample>& model_examples() {
  static const std::vector<ModelExample> examples{
      {.name = "dpd",
       .fluid = "a = 18.5\ngamma = 4.5\nkT = 1.0\n"
                "rattler_friction = { gamma = 0.1, cutoff = 1.2 }\n"
                "antisymmetric_stress = true\n",
       .pair = "a = 30.0\ns_bar = 1.7\ngamma_perp = 1.0\ncore = 0.3\n"},
      {.name = "table",
       .fluid = "force_file = \"soft.csv\"\ngamma = 4.5\nkT = 1.0\n",
       .pair = "force_file = \"steep.csv\"\nforce_below = \"constant\"\ncutoff = 0.9\n",
       .files = {{"fluid.force_file",
                  csv_of("r,f", 0.0, 1.0,
                         [](double r) { return 40.0 * r * (1.0 - r) * (1.0 - r); })},
                 {"pair.0.force_file",
                  csv_of("r,u", 0.3, 1.0, [](double r) { return 0.5 / r - 0.5; })}}},
      {.name = "gaussian",
       .fluid = "a = 18.5\nw = 0.3\ngamma = 4.5\nkT = 1.0\n",
       .pair = "a = 30.0\nw = 0.25\ncutoff = 0.9\ncore = 0.4\n"},
      {.name = "sdpd",
       .fluid = "eta = 3.0\nbulk_modulus = 40.0\nbackground_pressure = 40.0\nkT = 1.0\n",
       .pair = "eta = 4.5\n"},
      {.name = "mdpd",
       .fluid = "A = -10.0\nB = 12.0\nr_d = 0.9\nfilled = true\ngamma = 4.5\nkT = 1.0\n",
       .pair = "A = -8.0\nb = 0.9\ncutoff = 0.95\n"},
  };
  return examples;
}

/// A case of the example, half of whose particles are of species A, half of B; `rest`: further tables.
inline odpd::Config example_config(const ModelExample& example, int dimension, double edge,
                                   const std::string& rest = "") {
  std::string box, periodic;
  for (int c = 0; c < dimension; ++c) {
    box += (c > 0 ? ", " : "") + std::to_string(edge);
    periodic += c > 0 ? ", true" : "true";
  }
  const odpd::Config config = odpd::Config::from_text(
      "dimension = " + std::to_string(dimension) + "\n[box]\nsize = [" + box + "]\nperiodic = [" +
          periodic + "]\n[[species]]\nname = \"A\"\nfraction = 0.5\n[[species]]\nname = \"B\"\n" +
          "fraction = 0.5\n[fluid]\nmodel = \"" + example.name + "\"\ndensity = 4.0\n" +
          example.fluid + "[[pair]]\nspecies = [\"A\", \"B\"]\n" + example.pair + rest,
      "case.toml");
  config.use_file_texts(example.files);
  return config;
}

}  // namespace support
