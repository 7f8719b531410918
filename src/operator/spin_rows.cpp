#include "odpd/operator/spin_rows.h"

#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "odpd/core/index.h"
#include "odpd/core/isa.h"
#include "odpd/core/parallel.h"
#include "sliced_kernels.h"

namespace odpd {

namespace {

constexpr std::int64_t lane_count = 16;
constexpr std::int64_t own_floats = 3 * lane_count;  // velocity, spin, inertia
template <int D>
constexpr std::int64_t spin_slot_floats = lane_count*(D + 5);
constexpr std::size_t most_links = 255;  // longer rows share a bucket of the sort

float offset_bits(std::int64_t offset) {
  return std::bit_cast<float>(static_cast<std::int32_t>(offset));
}

const SlicedKernels& row_kernels() { return for_isa(sliced_portable, sliced_avx2, sliced_avx512); }

}  // namespace

template <int D>
bool SpinRows<D>::bodies_spin(const SpinResistance<D>& resistance) {
  const RigidResistance<D>& velocities = resistance.velocities();
  if (&velocities.system() != &velocities) return false;
  const auto rows = velocities.map().rows();
  return std::any_of(rows.begin(), rows.end(), [&](std::int32_t row) {
    const auto links = resistance.links(index(row));
    return std::any_of(links.begin(), links.end(), [](const auto& link) { return link.own > 0.0; });
  });
}

template <int D>
void SpinRows<D>::clear() {
  places_ = 0;
}

template <int D>
std::int64_t SpinRows<D>::bytes() const {
  if (empty()) return 0;
  return (own_.size() + links_.size()) * static_cast<std::int64_t>(sizeof(float)) +
         static_cast<std::int64_t>((begin_.size() + start_.size()) * sizeof(std::int64_t) +
                                   2 * row_.size() * sizeof(std::int32_t));
}

template <int D>
void SpinRows<D>::pack(const SpinResistance<D>& resistance, const SlicedRows<D>& rows) {
  first_place_ = rows.places();
  places_ = places_of(resistance.spins());
  const std::int64_t windows = (rows.places() + window - 1) / window;
  order_.resize(index(windows));
  begin_.assign(index(windows) + 1, 0);
  parallel_blocks(windows, [&](std::int64_t w) { sort_window(resistance, rows, w); });
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  row_.assign(index(begin_.back() * lane_count), -1);
  start_.assign(index(begin_.back()) + 1, 0);
  parallel_blocks(windows, [&](std::int64_t w) {
    const std::vector<std::int32_t>& order = order_[index(w)];
    std::copy(order.begin(), order.end(), row_.begin() + begin_[index(w)] * lane_count);
    for (std::int64_t slice = begin_[index(w)]; slice < begin_[index(w) + 1]; ++slice)
      for (std::int64_t lane = 0; lane < lane_count; ++lane) {
        const std::int32_t row = row_[index(slice * lane_count + lane)];
        if (row < 0) break;
        auto& longest = start_[index(slice) + 1];
        longest = std::max<std::int64_t>(longest, std::ssize(resistance.links(index(row))));
      }
  });
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  own_.resize(begin_.back() * own_floats);
  links_.resize(start_.back() * spin_slot_floats<D>);
  parallel_blocks(begin_.back(), [&](std::int64_t slice) { fill_slice(resistance, rows, slice); });
}

/// The rows of a window that have links or a spin, by falling number of links, ties by place.
template <int D>
void SpinRows<D>::sort_window(const SpinResistance<D>& resistance, const SlicedRows<D>& rows,
                              std::int64_t w) {
  const std::int64_t first = w * window, last = std::min(first + window, rows.places());
  std::array<std::int32_t, most_links + 2> bucket{};
  const auto visit = [&](const auto& what) {
    for (std::int64_t place = first; place < last; ++place) {
      const std::int32_t row = rows.node_of_place()[index(place)];
      if (row < 0) continue;
      const std::size_t links = resistance.links(index(row)).size();
      if (links > 0 || resistance.spin_of(index(row)) >= 0)
        what(row, most_links - std::min(links, most_links));
    }
  };
  visit([&](std::int32_t, std::size_t at) { ++bucket[at + 1]; });
  std::partial_sum(bucket.begin(), bucket.end(), bucket.begin());
  std::vector<std::int32_t>& order = order_[index(w)];
  order.resize(index(bucket.back()));
  visit([&](std::int32_t row, std::size_t at) { order[index(bucket[at]++)] = row; });
  begin_[index(w) + 1] = (std::ssize(order) + lane_count - 1) / lane_count;
}

template <int D>
void SpinRows<D>::fill_slice(const SpinResistance<D>& resistance, const SlicedRows<D>& rows,
                             std::int64_t slice) {
  constexpr std::int64_t stride = SlicedRows<D>::stride;
  const float nothing = offset_bits((first_place_ + places_ - 1) * stride);
  const auto velocity_of = [&](std::int32_t row) {
    return row < 0 ? nothing : offset_bits(rows.place_of_node()[index(row)] * stride);
  };
  const auto spin_of = [&](std::int32_t row) {
    const std::int32_t spin = row < 0 ? -1 : resistance.spin_of(index(row));
    return spin < 0 ? nothing : offset_bits((first_place_ + spin) * stride);
  };
  // 1/R: a lever in units of the spin's unknown; of what has none it sees nothing.
  const auto per_length = [&](std::int32_t row) {
    const std::int32_t spin = row < 0 ? -1 : resistance.spin_of(index(row));
    return spin < 0 ? 0.0 : 1.0 / resistance.length(index(spin));
  };
  const std::int64_t slots = start_[index(slice) + 1] - start_[index(slice)];
  for (std::int64_t lane = 0; lane < lane_count; ++lane) {
    const std::int32_t row = row_[index(slice * lane_count + lane)];
    float* const own = own_.data() + slice * own_floats + lane;
    own[0] = velocity_of(row);
    own[lane_count] = spin_of(row);
    const double per_own = per_length(row);
    own[2 * lane_count] =
        per_own == 0.0
            ? 0.0F
            : static_cast<float>(resistance.spin_shift(index(resistance.spin_of(index(row)))));
    float* slot = links_.data() + start_[index(slice)] * spin_slot_floats<D> + lane;
    std::int64_t filled = 0;
    if (row >= 0)
      for (const auto& link : resistance.links(index(row))) {
        float* out = slot;
        const auto put = [&out](float value) {
          *out = value;
          out += lane_count;
        };
        put(velocity_of(link.other));
        put(spin_of(link.other));
        for (const double component : link.e.x) put(static_cast<float>(component));
        put(static_cast<float>(link.zeta_perp));
        put(static_cast<float>(link.own * per_own));
        put(static_cast<float>(link.theirs * per_length(link.other)));
        slot += spin_slot_floats<D>;
        ++filled;
      }
    for (; filled < slots; ++filled, slot += spin_slot_floats<D>) {
      slot[0] = slot[lane_count] = nothing;
      for (std::int64_t k = 2; k < D + 5; ++k) slot[k * lane_count] = 0.0F;
    }
  }
}

template <int D>
double SpinRows<D>::product(const float* x, float* y, std::int64_t first, std::int64_t last) const {
  const std::int64_t from = std::min(first, first_place_), to = std::min(last, first_place_);
  if (empty() || from == to) return 0.0;
  const SpinView view{start_.data(), own_.data(), links_.data(),
                      (first_place_ + places_ - 1) * SlicedRows<D>::stride};
  return row_kernels().spin_product[D - 2](view, x, y, begin_[index(from / window)],
                                           begin_[index((to + window - 1) / window)]);
}

template class SpinRows<2>;
template class SpinRows<3>;

}  // namespace odpd
