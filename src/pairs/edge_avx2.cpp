#define ODPD_TABLE edge_avx2
#include "edge_kernels.inc"
