#include "multilevel_kernels.inc"

namespace odpd {
const MultilevelKernels multilevel_portable = multilevel_table;
}  // namespace odpd
