#include "sliced_kernels.inc"

namespace odpd {
const SlicedKernels sliced_avx2 = sliced_table;
}  // namespace odpd
