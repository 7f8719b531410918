#define ODPD_TABLE pair_search_portable
#include "pair_search_kernels.inc"
