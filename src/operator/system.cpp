#include "odpd/operator/system.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "odpd/core/error.h"
#include "odpd/core/parallel.h"

namespace odpd {

namespace {

constexpr std::int64_t nodes_per_sum = 1024;

std::size_t index(std::int64_t i) { return static_cast<std::size_t>(i); }

void require(bool good, const char* what) {
  if (!good) throw SolverError(fmt::format("assembled matrix: {}", what));
}

void validate(const BlockCsr& a) {
  require(a.block > 0 && a.rows >= 0, "block size and number of rows must be positive");
  require(a.start.size() == index(a.rows) + 1 && a.start.front() == 0,
          "start must hold rows + 1 offsets, the first one 0");
  require(index(a.start.back()) == a.column.size(), "start must end at the number of blocks");
  require(a.value.size() == a.column.size() * index(a.block) * index(a.block),
          "value must hold block * block numbers per stored block");
  for (std::int32_t row = 0; row < a.rows; ++row) {
    require(a.start[index(row)] <= a.start[index(row) + 1], "start must not decrease");
    for (std::int32_t k = a.start[index(row)]; k < a.start[index(row) + 1]; ++k) {
      require(a.column[index(k)] >= 0 && a.column[index(k)] < a.rows, "column out of range");
      require(k == a.start[index(row)] || a.column[index(k) - 1] < a.column[index(k)],
              "columns of a row must ascend");
    }
  }
}

}  // namespace

void System::project(std::span<double> x) const {
  if (projected())
    remove_mean(x.last(static_cast<std::size_t>(translating_nodes() * block_size())), block_size());
}

void remove_mean(std::span<double> x, int block) {
  const std::size_t b = index(block);
  const std::int64_t nodes = static_cast<std::int64_t>(x.size() / b);
  if (nodes == 0) return;
  // Sums in fixed blocks of nodes, whatever the threads, as fixed_sum does.
  const std::int64_t sums = (nodes + nodes_per_sum - 1) / nodes_per_sum;
  std::vector<double> partial(index(sums) * b, 0.0);
  parallel_for(sums, [&](std::int64_t s) {
    double* const sum = &partial[index(s) * b];
    const std::int64_t end = std::min(nodes, (s + 1) * nodes_per_sum);
    for (std::int64_t i = s * nodes_per_sum; i < end; ++i) {
      for (std::size_t k = 0; k < b; ++k) sum[k] += x[index(i) * b + k];
    }
  });
  std::vector<double> mean(b, 0.0);
  for (std::size_t s = 0; s < index(sums); ++s) {
    for (std::size_t k = 0; k < b; ++k) mean[k] += partial[s * b + k];
  }
  for (double& m : mean) m /= static_cast<double>(nodes);
  parallel_for(nodes, [&](std::int64_t i) {
    for (std::size_t k = 0; k < b; ++k) x[index(i) * b + k] -= mean[k];
  });
}

AssembledSystem::AssembledSystem(BlockCsr matrix, bool translations_are_null,
                                 bool holds_centre_of_mass)
    : matrix_(std::move(matrix)), null_(translations_are_null), held_(holds_centre_of_mass) {
  validate(matrix_);
}

void AssembledSystem::apply(std::span<const double> x, std::span<double> y) const {
  const std::size_t b = index(matrix_.block);
  parallel_for(matrix_.rows, [&](std::int64_t row) {
    double* const out = &y[index(row) * b];
    std::fill(out, out + b, 0.0);
    for (std::int32_t k = matrix_.start[index(row)]; k < matrix_.start[index(row) + 1]; ++k) {
      const double* const value = &matrix_.value[index(k) * b * b];
      const double* const in = &x[index(matrix_.column[index(k)]) * b];
      for (std::size_t i = 0; i < b; ++i) {
        for (std::size_t j = 0; j < b; ++j) out[i] += value[i * b + j] * in[j];
      }
    }
  });
}

void AssembledSystem::block_diagonal(std::span<double> blocks) const {
  const std::size_t bb = index(matrix_.block) * index(matrix_.block);
  std::fill(blocks.begin(), blocks.end(), 0.0);
  for (std::int32_t row = 0; row < matrix_.rows; ++row) {
    for (std::int32_t k = matrix_.start[index(row)]; k < matrix_.start[index(row) + 1]; ++k) {
      if (matrix_.column[index(k)] != row) continue;
      std::copy_n(&matrix_.value[index(k) * bb], bb, &blocks[index(row) * bb]);
    }
  }
}

}  // namespace odpd
