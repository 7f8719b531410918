#pragma once
// The translations E of a vector of unknowns, `block` numbers per node: column c moves component c of every velocity by 1, or
// by the node's weight.
//
//   sums(x) = E^T x,   add(a, x): x := x + E a,   remove_mean(x): x := x - E (E^T E)^-1 E^T x
//
// Unknowns that a translation leaves alone stand in front: whole nodes (angular velocities of rigid bodies) and the first
// components of a node (spins). A scalar field has block = components = 1, and its translation is the constant. Weights are
// for unknowns that are velocities in units of their own (operator/rigid_resistance.h).
#include <cstdint>
#include <span>
#include <vector>

#include "odpd/core/communicator.h"
#include "odpd/core/index.h"

namespace odpd {

struct Translations {
  int block = 1;           ///< unknowns per node
  std::int64_t nodes = 0;  ///< the last ones of the vector
  int components = 1;      ///< the last ones of a node
  /// Of the last nodes, as many as there are; all others weigh 1. Must outlive the use of this value.
  std::span<const double> weights = {};

  double weight(std::int64_t n) const {
    const std::int64_t k = n - nodes + std::ssize(weights);
    return k < 0 ? 1.0 : weights[index(k)];
  }
  /// First of the translated unknowns of node n of these, in the part of `x` that belongs to them.
  std::size_t first(std::int64_t n) const { return index(n * block + block - components); }
  // `share`: the nodes of this rank among all of the vector (System::share).

  /// E^T E, the same number for each column, over all ranks, for a vector of this size: without weights the nodes.
  double squares(std::size_t size, const Share& share = {}) const;
  /// Node by node, in order.
  std::vector<double> sums(std::span<const double> x, const Share& share = {}) const;
  /// a: `components` numbers.
  void add(std::span<const double> a, std::span<double> x) const;
  /// The same bits on any thread count.
  void remove_mean(std::span<double> x, const Share& share = {}) const;

 private:
  struct Range {
    std::int64_t first, last;
  };
  /// Which of the nodes that are translated belong to the share.
  Range own(std::size_t size, const Share& share) const;
  double squares(const Range& range) const;
  std::size_t in_front(std::size_t size) const { return size - index(nodes * block); }
};

}  // namespace odpd
