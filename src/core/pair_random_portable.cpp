#define ODPD_TABLE pair_random_portable
#include "pair_random_kernels.inc"
