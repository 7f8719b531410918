#pragma once
// The product with the packed rows of R (odpd/operator/sliced_rows.h) and the bytes that it and an iteration move.
#include <algorithm>
#include <cstdint>
#include <limits>

#include "odpd/core/parallel.h"
#include "odpd/core/timer.h"
#include "odpd/operator/sliced_rows.h"

namespace bench {

/// The fastest of as many calls as fit into half a second, at least three.
template <class Work>
double best_seconds(const Work& work) {
  double best = std::numeric_limits<double>::infinity();
  double spent = 0.0;
  for (int repeat = 0; repeat < 1000 && (repeat < 3 || spent < 0.5); ++repeat) {
    const odpd::Stopwatch watch;
    work();
    const double seconds = watch.seconds();
    best = std::min(best, seconds);
    spent += seconds;
  }
  return best;
}

struct Packed {
  double seconds = 0.0;        ///< of one product
  double product_bytes = 0.0;  ///< rows, x in, y out
  /// Of one iteration of conjugate gradients with block-Jacobi: a product, the triangles of the inverse blocks, ten more
  /// passes over vectors (update: p, q, d, r in, d, r, z out; direction: z, p in, p out).
  double iteration_bytes = 0.0;
};

template <int D>
Packed pack_and_multiply(const odpd::Resistance<D>& resistance) {
  constexpr std::int64_t block = 1024;
  odpd::SlicedRows<D> rows;
  rows.pack(resistance);
  odpd::FloatArray x, y;
  x.resize(rows.vector_size());
  y.resize(rows.vector_size());
  x.fill(1.0F);
  y.fill(0.0F);
  const std::int64_t places = rows.places();
  Packed packed;
  packed.seconds = best_seconds([&] {
    odpd::parallel_blocks((places + block - 1) / block, [&](std::int64_t k) {
      rows.product(x.data(), y.data(), k * block, std::min(places, (k + 1) * block));
    });
  });
  const double vector = 4.0 * static_cast<double>(rows.vector_size());
  const double order = 4.0 * static_cast<double>(rows.node_of_place().size() +
                                                 rows.place_of_node().size());  // not in a product
  packed.product_bytes = static_cast<double>(rows.bytes()) - order + 2.0 * vector;
  packed.iteration_bytes =
      packed.product_bytes + 4.0 * static_cast<double>(places * (D * (D + 1) / 2)) + 10.0 * vector;
  return packed;
}

}  // namespace bench
