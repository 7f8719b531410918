#pragma once
// Which instruction path the vectorised kernels take. One binary holds all of them; the choice is made once per process:
// the best the processor has, or what the environment variable ODPD_ISA says.
//
// A path computes the same bits on any processor and on any number of threads; two paths differ in rounding (fused
// multiply-adds, lengths of partial sums).
#include <string_view>

namespace odpd {

enum class Isa {
  portable,  ///< plain x86-64 (or any other processor)
  avx2,      ///< AVX2 and FMA
  avx512,    ///< AVX-512 F, DQ, BW and VL
};

/// The path of this process. Throws ConfigError when ODPD_ISA names none, or one that this processor lacks.
Isa isa();
std::string_view isa_name(Isa isa);

/// The path's entry of a table of kernels, one per path.
template <class Kernels>
const Kernels& for_isa(const Kernels& portable, const Kernels& avx2, const Kernels& avx512) {
  return isa() == Isa::avx512 ? avx512 : isa() == Isa::avx2 ? avx2 : portable;
}

}  // namespace odpd
