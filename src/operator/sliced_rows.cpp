#include "odpd/operator/sliced_rows.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

#include "odpd/core/index.h"
#include "odpd/core/isa.h"
#include "odpd/core/parallel.h"
#include "sliced_kernels.h"

namespace odpd {

namespace {

constexpr std::int64_t slice_rows = 16;
constexpr std::int64_t window_rows = 256;
constexpr std::size_t most_counted = 255;  // longer rows share a bucket of the sort

const SlicedKernels& kernels() { return for_isa(sliced_portable, sliced_avx2, sliced_avx512); }

template <int D>
constexpr std::int64_t triangle = D*(D + 1) / 2;

float as_float_bits(std::int64_t offset) {
  return std::bit_cast<float>(static_cast<std::int32_t>(offset));
}

}  // namespace

void FloatArray::resize(std::int64_t size) {
  size_ = size;
  if (size <= capacity_) return;
  // Some room to spare: the number of edges changes a little from step to step.
  capacity_ = size + size / 16;
  data_.reset();
  data_.reset(static_cast<float*>(
      ::operator new[](index(capacity_) * sizeof(float), std::align_val_t{64})));
}

void FloatArray::fill(float value) { std::fill_n(data_.get(), size_, value); }

template <int D>
std::int64_t SlicedRows<D>::vector_size() const {
  return places() * stride;
}

template <int D>
std::int64_t SlicedRows<D>::bytes() const {
  return (links_.size() + anchor_.size()) * static_cast<std::int64_t>(sizeof(float)) +
         static_cast<std::int64_t>(start_.size() * sizeof(std::int64_t) +
                                   (node_of_place_.size() + place_of_node_.size()) *
                                       sizeof(std::int32_t));
}

template <int D>
void SlicedRows<D>::pack(const Resistance<D>& resistance) {
  const std::int64_t nodes = resistance.nodes();
  const std::int64_t slices = (nodes + slice_rows - 1) / slice_rows;
  across_ = resistance.transverse();
  node_of_place_.resize(index(slices * slice_rows));
  place_of_node_.resize(index(nodes));
  start_.resize(index(slices) + 1);
  start_[0] = 0;
  parallel_blocks((nodes + window_rows - 1) / window_rows,
                  [&](std::int64_t window) { sort_window(resistance, window); });
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  links_.resize(start_.back() * slice_rows * (1 + D + (across_ ? 1 : 0)));
  anchor_.resize(resistance.anchors().empty() ? 0 : slices * slice_rows * triangle<D>);
  parallel_blocks(slices, [&](std::int64_t slice) { fill_slice(resistance, slice); });
}

/// Orders the nodes of a window by falling degree, ties by number; notes the length of each slice.
template <int D>
void SlicedRows<D>::sort_window(const Resistance<D>& resistance, std::int64_t window) {
  const std::int64_t first = window * window_rows;
  const std::int64_t last = std::min(first + window_rows, resistance.nodes());
  const auto degree = [&](std::int64_t node) {
    return std::min(resistance.links(index(node)).size(), most_counted);
  };
  std::array<std::int32_t, most_counted + 2> begin{};
  for (std::int64_t node = first; node < last; ++node) ++begin[most_counted - degree(node) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  for (std::int64_t node = first; node < last; ++node) {
    const std::int64_t place = first + begin[most_counted - degree(node)]++;
    node_of_place_[index(place)] = static_cast<std::int32_t>(node);
    place_of_node_[index(node)] = static_cast<std::int32_t>(place);
  }
  for (std::int64_t slice = first / slice_rows; slice * slice_rows < last; ++slice) {
    std::size_t longest = 0;
    for (std::int64_t place = slice * slice_rows; place < (slice + 1) * slice_rows; ++place) {
      auto& node = node_of_place_[index(place)];
      if (place >= last)
        node = -1;
      else
        longest = std::max(longest, resistance.links(index(node)).size());
    }
    start_[index(slice) + 1] = static_cast<std::int64_t>(longest);
  }
}

template <int D>
void SlicedRows<D>::fill_slice(const Resistance<D>& resistance, std::int64_t slice) {
  const std::int64_t slot_floats = slice_rows * (1 + D + (across_ ? 1 : 0));
  float* const out = links_.data() + start_[index(slice)] * slot_floats;
  const std::int64_t slots = start_[index(slice) + 1] - start_[index(slice)];
  for (std::int64_t lane = 0; lane < slice_rows; ++lane) {
    const std::int64_t place = slice * slice_rows + lane;
    const std::int32_t node = node_of_place_[index(place)];
    float* slot = out + lane;
    std::int64_t filled = 0;
    if (node >= 0) {
      for (const auto& link : resistance.links(index(node))) {
        slot[0] = as_float_bits(place_of_node_[index(link.node)] * stride);
        for (std::int64_t c = 0; c < D; ++c)
          slot[(1 + c) * slice_rows] = static_cast<float>(resistance.g(link).x[index(c)]);
        if (across_) {
          const auto& a = resistance.across(link);
          slot[(1 + D) * slice_rows] =
              std::copysign(static_cast<float>(a.zeta_perp), static_cast<float>(a.sign));
        }
        slot += slot_floats;
        ++filled;
      }
    }
    for (; filled < slots; ++filled, slot += slot_floats) {  // links to itself without friction
      slot[0] = as_float_bits(place * stride);
      for (std::int64_t k = 1; k < slot_floats / slice_rows; ++k) slot[k * slice_rows] = 0.0F;
    }
    if (anchor_.size() == 0) continue;
    float* anchor = anchor_.data() + slice * slice_rows * triangle<D> + lane;
    for (std::size_t row = 0; row < D; ++row)
      for (std::size_t col = row; col < D; ++col, anchor += slice_rows)
        *anchor =
            node < 0 ? 0.0F : static_cast<float>(resistance.anchors()[index(node)][row * D + col]);
  }
}

template <int D>
double SlicedRows<D>::product(const float* x, float* y, std::int64_t first,
                              std::int64_t last) const {
  const SlicedView view{start_.data(), links_.data(),
                        anchor_.size() == 0 ? nullptr : anchor_.data()};
  const auto& table = across_ ? kernels().product_across : kernels().product;
  return table[D - 2](view, x, y, first / slice_rows, last / slice_rows);
}

template class SlicedRows<2>;
template class SlicedRows<3>;

}  // namespace odpd
