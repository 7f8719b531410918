#include "multilevel_kernels.h"

#include "odpd/core/isa.h"

namespace odpd {

const MultilevelKernels& multilevel_kernels() {
  return for_isa(multilevel_portable, multilevel_avx2, multilevel_avx512);
}

}  // namespace odpd
