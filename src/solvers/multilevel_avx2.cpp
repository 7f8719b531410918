#include "multilevel_kernels.inc"

namespace odpd {
const MultilevelKernels multilevel_avx2 = multilevel_table;
}  // namespace odpd
