#include "sliced_kernels.inc"

namespace odpd {
const SlicedKernels sliced_avx512 = sliced_table;
}  // namespace odpd
