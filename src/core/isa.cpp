#include "odpd/core/isa.h"

#include <fmt/format.h>

#include <cstdlib>
#include <string>

#include "odpd/core/error.h"

namespace odpd {

namespace {

bool processor_has(Isa isa) {
#if defined(__x86_64__)
  if (isa == Isa::avx512)
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
  if (isa == Isa::avx2) return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#endif
  return isa == Isa::portable;
}

Isa choose() {
  const char* const asked = std::getenv("ODPD_ISA");
  for (const Isa isa : {Isa::avx512, Isa::avx2, Isa::portable}) {
    if (asked == nullptr || *asked == '\0') {
      if (processor_has(isa)) return isa;
    } else if (isa_name(isa) == asked) {
      if (processor_has(isa)) return isa;
      throw ConfigError(fmt::format(
          "ODPD_ISA={}: this processor lacks it; unset ODPD_ISA for the best it has", asked));
    }
  }
  throw ConfigError(fmt::format(
      "ODPD_ISA={}: no such instruction path; the names are avx512, avx2, portable", asked));
}

}  // namespace

Isa isa() {
  static const Isa chosen = choose();
  return chosen;
}

std::string_view isa_name(Isa isa) {
  return isa == Isa::avx512 ? "avx512" : isa == Isa::avx2 ? "avx2" : "portable";
}

}  // namespace odpd
