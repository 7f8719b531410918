#include "prediction.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace bench {

namespace {

struct Size {
  double particles, seconds, bytes;
};

double extrapolated(double n, double n_last, double last, double n_before, double before,
                    double fallback) {
  const bool two = n_before > 0.0 && before > 0.0;
  const double exponent =
      two ? std::max(1.0, std::log(last / before) / std::log(n_last / n_before)) : fallback;
  return last * std::pow(n / n_last, exponent);
}

}  // namespace

Prediction predict(const Results& solves, const Backend& backend, int dimension,
                   const std::string& geometry, double tolerance, std::int64_t particles) {
  std::vector<Size> sizes;
  double unsolved = 0.0;
  const double n = static_cast<double>(particles);
  for (std::size_t k = 0; k < solves.size(); ++k) {
    const double smaller = solves.number(k, "N");
    if (solves.word(k, "dimension") != std::to_string(dimension) ||
        solves.word(k, "geometry") != geometry || solves.word(k, "backend") != backend.name ||
        solves.number(k, "tolerance") != tolerance || smaller >= n)
      continue;
    if (solves.word(k, "status") == "ok") {
      sizes.push_back({smaller, solves.number(k, "setup_s") + solves.number(k, "solve_s"),
                       std::fmax(solves.number(k, "bytes_per_particle"),
                                 solves.number(k, "peak_bytes_per_particle")) *
                           smaller});
    } else {
      unsolved = std::max(unsolved, smaller);
    }
  }
  std::sort(sizes.begin(), sizes.end(),
            [](const Size& a, const Size& b) { return a.particles > b.particles; });
  Prediction result;
  if (unsolved > (sizes.empty() ? 0.0 : sizes[0].particles)) {
    result.objection = fmt::format("no result at N = {:g} to go by", unsolved);
    return result;
  }
  if (sizes.empty()) return result;
  const Size last = sizes[0];
  const Size before = sizes.size() > 1 ? sizes[1] : Size{0.0, 0.0, 0.0};
  const double growth = dimension == 2 ? backend.growth_2d : backend.growth_3d;
  result.seconds =
      extrapolated(n, last.particles, last.seconds, before.particles, before.seconds, growth);
  result.bytes = extrapolated(n, last.particles, last.bytes, before.particles, before.bytes,
                              backend.memory_growth);
  return result;
}

std::size_t solved_twin(const Results& solves, const std::vector<std::string>& key) {
  for (std::size_t k = 0; k < solves.size(); ++k)
    if (solves.word(k, "dimension") == key[0] && solves.word(k, "geometry") == key[1] &&
        solves.word(k, "N") == key[2] && solves.word(k, "backend") == key[3] &&
        solves.word(k, "threads") == key[5] && solves.word(k, "status") == "ok")
      return k;
  return solves.size();
}

}  // namespace bench
