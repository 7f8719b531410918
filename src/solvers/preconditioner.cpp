#include "odpd/solvers/preconditioner.h"

#include <fmt/format.h>

#include <cmath>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"

namespace odpd {

namespace {

// A pivot below this fraction of its diagonal is rounding: fewer than d independent neighbours.
constexpr double smallest_pivot = 1e-13;

/// Lower Cholesky factor in place (the upper part is not touched).
bool factor(std::span<double> a, std::size_t b) {
  for (std::size_t j = 0; j < b; ++j) {
    const double diagonal = a[j * b + j];
    double pivot = diagonal;
    for (std::size_t k = 0; k < j; ++k) pivot -= a[j * b + k] * a[j * b + k];
    if (!(diagonal > 0.0) || !(pivot > smallest_pivot * diagonal) || !std::isfinite(pivot))
      return false;
    const double root = std::sqrt(pivot);
    a[j * b + j] = root;
    for (std::size_t i = j + 1; i < b; ++i) {
      double s = a[i * b + j];
      for (std::size_t k = 0; k < j; ++k) s -= a[i * b + k] * a[j * b + k];
      a[i * b + j] = s / root;
    }
  }
  return true;
}

/// L := L^-1 in place, lower triangle.
void invert_lower(std::span<double> a, std::size_t b) {
  for (std::size_t j = 0; j < b; ++j) {
    a[j * b + j] = 1.0 / a[j * b + j];
    for (std::size_t i = j + 1; i < b; ++i) {
      double s = 0.0;
      for (std::size_t k = j; k < i; ++k) s -= a[i * b + k] * a[k * b + j];
      a[i * b + j] = s / a[i * b + i];
    }
  }
}

template <int B>
void multiply(const std::vector<double>& blocks, int block, std::span<const double> r,
              std::span<double> z) {
  const std::size_t b = index(B > 0 ? B : block);
  parallel_for(static_cast<std::int64_t>(r.size() / b), [&](std::int64_t node) {
    const std::size_t n = index(node);
    const double* const m = &blocks[n * b * b];
    for (std::size_t i = 0; i < b; ++i) {
      double s = 0.0;
      for (std::size_t j = 0; j < b; ++j) s += m[i * b + j] * r[n * b + j];
      z[n * b + i] = s;
    }
  });
}

std::vector<double> block_diagonal(const System& system) {
  const std::int64_t b = system.block_size();
  std::vector<double> blocks(index(system.nodes() * b * b));
  system.block_diagonal(blocks);
  return blocks;
}

}  // namespace

void reject_block(std::int64_t node) {
  throw SolverError(
      fmt::format(
          "node {} is not held: its diagonal block is not positive definite (fewer independent "
          "neighbours than directions, or a negative weight); give the particles mass, or add a "
          "weak pairwise friction of longer range",
          node),
      SolverError::Cause::singular);
}

bool invert_definite(std::span<double> block, int size) {
  const std::size_t b = index(size);
  if (!factor(block, b)) return false;
  invert_lower(block, b);
  // L^-T L^-1 in place: its row i needs only rows k >= i of L^-1.
  for (std::size_t i = 0; i < b; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double s = 0.0;
      for (std::size_t k = i; k < b; ++k) s += block[k * b + i] * block[k * b + j];
      block[i * b + j] = s;
      block[j * b + i] = s;
    }
  }
  return true;
}

void require_definite_diagonal(const System& system) {
  std::vector<double> blocks = block_diagonal(system);
  const std::size_t b = index(system.block_size());
  for (std::int64_t node = 0; node < system.nodes(); ++node) {
    const std::size_t at = index(node) * b * b;
    if (!factor(std::span(blocks).subspan(at, b * b), b)) reject_block(node);
  }
}

void BlockJacobi::set_up(const System& system) {
  block_ = system.block_size();
  inverse_ = block_diagonal(system);
  const std::size_t bb = index(block_ * block_);
  const Share share = system.share();
  share.ranks->together([&] {
    for (std::int64_t node = 0; node < system.nodes(); ++node) {
      const std::size_t at = index(node) * bb;
      const bool good = invert_definite(std::span(inverse_).subspan(at, bb), block_);
      if (!good && share.owns(node)) reject_block(node);
    }
  });
}

void BlockJacobi::apply(std::span<const double> r, std::span<double> z) const {
  if (block_ == 2) {
    multiply<2>(inverse_, block_, r, z);
  } else if (block_ == 3) {
    multiply<3>(inverse_, block_, r, z);
  } else {
    multiply<0>(inverse_, block_, r, z);
  }
}

std::int64_t BlockJacobi::memory_bytes() const {
  return static_cast<std::int64_t>(inverse_.size() * sizeof(double));
}

}  // namespace odpd
