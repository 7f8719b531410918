#include "odpd/pairs/column.h"

#include "odpd/core/parallel.h"

namespace odpd {

void Column::fill(double value) {
  mask_ = 0;
  values_ = std::vector<double>{value};
}

std::span<double> Column::each() {
  if (!varies()) {
    mask_ = ~std::size_t{0};
    const double value = values_.front();
    values_.assign(size_, value);
  }
  return values_;
}

void Column::resize(std::size_t size) {
  size_ = size;
  if (!varies()) return;
  if (values_.capacity() < size) values_.reserve(size + size / 32);
  values_.resize(size);
}

double Column::sum() const {
  return varies() ? fixed_sum(values_) : static_cast<double>(size_) * values_.front();
}

}  // namespace odpd
