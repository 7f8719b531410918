#define ODPD_TABLE edge_avx512
#include "edge_kernels.inc"
