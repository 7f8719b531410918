#pragma once
// Kernels of PairRandom (core/random.h), one table per instruction path. All arrays hold a multiple of 8 entries.
#include <cstdint>

namespace odpd::kernels {

struct PairRandomKernels {
  /// out[k], a standard normal number of the pair (a[k], b[k]).
  void (*one)(std::uint64_t seed, std::uint64_t step, int n, const std::uint32_t* a,
              const std::uint32_t* b, double* out);
  /// out[c][k], four of them, independent of the one above.
  void (*four)(std::uint64_t seed, std::uint64_t step, int n, const std::uint32_t* a,
               const std::uint32_t* b, double* const* out);
};

extern const PairRandomKernels pair_random_portable, pair_random_avx2, pair_random_avx512;

}  // namespace odpd::kernels
