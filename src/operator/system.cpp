#include "odpd/operator/system.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"

namespace odpd {

namespace {

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

std::vector<std::vector<double>> System::null_space() const {
  std::vector<std::vector<double>> basis;
  const Translations moved = translations();
  for (std::size_t c = 0; translations_are_null() && c < index(moved.components); ++c) {
    std::vector<double> unit(index(moved.components), 0.0);
    unit[c] = 1.0 / std::sqrt(moved.squares(index(size()), share()));
    basis.emplace_back(index(size()), 0.0);
    moved.add(unit, basis.back());
  }
  basis.insert(basis.end(), null_motions().begin(), null_motions().end());
  return basis;
}

/// x := x - U U^T x.
void System::remove_null_motions(std::span<double> x) const {
  for (const std::vector<double>& u : null_motions()) {
    const double part = inner_product(u, x);
    parallel_for(static_cast<std::int64_t>(x.size()),
                 [&](std::int64_t k) { x[index(k)] -= part * u[index(k)]; });
  }
}

AssembledSystem::AssembledSystem(BlockCsr matrix, bool translations_are_null,
                                 bool holds_centre_of_mass)
    : matrix_(std::move(matrix)), null_(translations_are_null), held_(holds_centre_of_mass) {
  validate(matrix_);
  translations_ = {matrix_.block, matrix_.rows, matrix_.block};
}

AssembledSystem::AssembledSystem(BlockCsr matrix, Translations translations,
                                 bool translations_are_null, bool holds_centre_of_mass)
    : AssembledSystem(std::move(matrix), translations_are_null, holds_centre_of_mass) {
  translations_ = translations;
  require(translations.block == matrix_.block && translations.nodes >= 0 &&
              translations.nodes <= matrix_.rows && translations.components > 0 &&
              translations.components <= matrix_.block,
          "translations must move some of its unknowns");
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
