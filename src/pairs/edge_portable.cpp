#define ODPD_TABLE edge_portable
#include "edge_kernels.inc"
