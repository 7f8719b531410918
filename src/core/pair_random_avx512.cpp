#define ODPD_TABLE pair_random_avx512
#include "pair_random_kernels.inc"
