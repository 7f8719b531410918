#pragma once
// STREAM triad (McCalpin 1995): a_i = b_i + q c_i, 24 bytes per i.
namespace bench {

/// Best of five sweeps over 800 MB with `threads` threads, in 1e9 bytes per second.
double triad_bandwidth(int threads);

}  // namespace bench
