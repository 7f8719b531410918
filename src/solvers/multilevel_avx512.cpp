#include "multilevel_kernels.inc"

namespace odpd {
const MultilevelKernels multilevel_avx512 = multilevel_table;
}  // namespace odpd
