#include "sliced_kernels.inc"

namespace odpd {
const SlicedKernels sliced_portable = sliced_table;
}  // namespace odpd
