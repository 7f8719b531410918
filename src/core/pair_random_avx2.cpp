#define ODPD_TABLE pair_random_avx2
#include "pair_random_kernels.inc"
