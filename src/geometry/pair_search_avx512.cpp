#define ODPD_TABLE pair_search_avx512
#include "pair_search_kernels.inc"
