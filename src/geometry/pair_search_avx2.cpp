#define ODPD_TABLE pair_search_avx2
#include "pair_search_kernels.inc"
