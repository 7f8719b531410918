#include "odpd/solvers/multilevel.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "multilevel_kernels.h"
#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/solvers/galerkin.h"

namespace odpd {

namespace {

// Spacing of the grid in units of the friction range (solvers/galerkin.h): 1.7 r_c for w_D = (1 - r/r_c)^(1/2) in 3D.
constexpr double spacing_per_range = 2.5;
constexpr std::int64_t floats_per_place = 4;
// With fewer neighbours to share a particle's friction (4 to 5.2 at n = 3, s = 2; 10 to 14 at n = 4, s = 1/2) there are so many
// clusters that two steps leave 35 to 59 iterations where four leave 26 to 33, in about the same time.
constexpr double few_ties = 5.5;

/// w (1 - T(x(L))/T(x(0)))/L with T the Chebyshev polynomial of the degree, x = 1 at L = low and -1 at high.
LocalPart chebyshev(std::size_t degree, double low, double high, double weight) {
  const double x_0 = (high + low) / (high - low), slope = 2.0 / (high - low);
  std::vector<double> before{1.0}, t{x_0, -slope};  // coefficients of powers of L
  for (std::size_t k = 1; k < degree; ++k) {
    std::vector<double> next(k + 2, 0.0);
    for (std::size_t n = 0; n <= k; ++n) {
      next[n] += 2.0 * x_0 * t[n];
      next[n + 1] -= 2.0 * slope * t[n];
      if (n < k) next[n] -= before[n];
    }
    before = std::move(t);
    t = std::move(next);
  }
  LocalPart c(degree);
  for (std::size_t n = 0; n < degree; ++n) c[n] = weight * std::abs(t[n + 1] / t[0]);
  return c;
}

}  // namespace

template <int D>
void Multilevel<D>::set_up(const Resistance<D>& resistance, const SlicedRows<D>& rows,
                           const RigidResistance<D>* rigid, const SpinResistance<D>* spins) {
  ranks_ = resistance.share().ranks;
  const bool outdated =
      grid_.empty() || grid_.null_translations() != resistance.translations_are_null() ||
      shift_ != resistance.shift() || stiffness_time_ != resistance.stiffness_time();
  if (outdated || (remembers_ && last_rate_ < aged * fresh_rate_)) build(resistance, rigid, spins);
  place_nodes(resistance, rows, spins);
}

template <int D>
LocalPart Multilevel<D>::local() const {
  constexpr double bound = 2.15, weight = 2.0, low = 0.1, high = 2.0;
  if (ties_ < few_ties) return chebyshev(4, low, high, weight);
  return {weight * bound, weight};
}

template <int D>
void Multilevel<D>::note_rate(double decades_per_iteration) {
  if (!remembers_) return;
  last_rate_ = decades_per_iteration;
  if (fresh_rate_ == 0.0) fresh_rate_ = last_rate_;
}

template <int D>
void Multilevel<D>::build(const Resistance<D>& resistance, const RigidResistance<D>* rigid,
                          const SpinResistance<D>* spins) {
  const Share share = resistance.share();
  const FrictionSpread friction = friction_spread(resistance, rigid);
  ties_ = friction.ties;
  double spacing =
      friction.range > 0.0 ? spacing_per_range * friction.range : resistance.box().size[0];
  GridShape<D> shape = choose_grid(resistance.box(), resistance.positions(), spacing, share);
  // A sparse box: more points than particles would cost more than they help.
  const std::int64_t nodes = share.count(resistance.nodes());
  while (shape.points() > std::max<std::int64_t>(nodes, 1 << D)) {
    spacing *= 1.25;
    shape = choose_grid(resistance.box(), resistance.positions(), spacing, share);
  }
  grid_.set_up(galerkin(resistance, shape, rigid, friction.moment, spins),
               resistance.translations_are_null());
  shift_ = resistance.shift();
  stiffness_time_ = resistance.stiffness_time();
  fresh_rate_ = last_rate_ = 0.0;
  ++builds_;
}

std::int64_t chunk_begin(std::int64_t places, std::int64_t chunk) {
  constexpr std::int64_t block = 1024, chunks = Multilevel<2>::chunks();
  const std::int64_t blocks = (places + block - 1) / block;
  return std::min(places, (blocks * chunk + chunks - 1) / chunks * block);
}

template <int D>
void Multilevel<D>::place_nodes(const Resistance<D>& resistance, const SlicedRows<D>& rows,
                                const SpinResistance<D>* spins) {
  const GridShape<D>& shape = grid_.finest().shape();
  const std::int64_t grid_floats = shape.total() * SlicedRows<D>::stride;
  places_ = velocities_ = rows.places();
  std::vector<std::int32_t> row_of_spin;
  if (spins != nullptr) {
    row_of_spin.assign(index(SpinRows<D>::places_of(spins->spins())), -1);
    parallel_for(resistance.nodes(), [&](std::int64_t row) {
      const std::int32_t spin = spins->spin_of(index(row));
      if (spin >= 0) row_of_spin[index(spin)] = static_cast<std::int32_t>(row);
    });
    places_ += std::ssize(row_of_spin);
    half_length_.resize(std::ssize(row_of_spin));
    for (std::size_t spin = 0; spin < row_of_spin.size(); ++spin)
      half_length_.data()[spin] =
          row_of_spin[spin] < 0 ? 0.0F : static_cast<float>(0.5 * spins->length(spin));
    const std::array<Vec<D>, D> slopes = grid_slopes(resistance.box(), shape);
    for (std::size_t c = 0; c < D; ++c)
      for (std::size_t a = 0; a < D; ++a) slopes_[4 * c + a] = static_cast<float>(slopes[c].x[a]);
  }
  place_.resize(places_ * floats_per_place);
  restricted_.resize(chunks() * grid_floats);
  correction_.resize(grid_floats);
  touched_begin_.assign(index(chunks()), grid_floats);
  touched_end_.assign(index(chunks()), 0);
  const std::int64_t reach =
      shape.corner_offset(GridShape<D>::corners - 1) * SlicedRows<D>::stride +
      SlicedRows<D>::stride;
  parallel_blocks(chunks(), [&](std::int64_t chunk) {
    std::int64_t begin = grid_floats, end = 0;
    for (std::int64_t place = chunk_begin(places_, chunk); place < chunk_begin(places_, chunk + 1);
         ++place) {
      const std::int32_t node = place < velocities_ ? rows.node_of_place()[index(place)]
                                                    : row_of_spin[index(place - velocities_)];
      float* const out = place_.data() + floats_per_place * place;
      GridPosition<D> at{};
      if (node >= 0) at = locate(shape, grid_position(resistance, index(node)).x.data());
      for (std::size_t c = 0; c < D; ++c) out[c] = at.in_cell[c];
      const std::int64_t base = shape.number_of(at.cell) * SlicedRows<D>::stride;
      out[3] = std::bit_cast<float>(static_cast<std::int32_t>(base));
      begin = std::min(begin, base);
      end = std::max(end, base + reach);
    }
    touched_begin_[index(chunk)] = begin;
    touched_end_[index(chunk)] = end;
  });
}

namespace {

template <int D>
TransferView view(const FloatArray& place, const GridShape<D>& shape) {
  TransferView v{};
  v.place = place.data();
  for (int k = 0; k < GridShape<D>::corners; ++k)
    v.corner[k] = shape.corner_offset(k) * SlicedRows<D>::stride;
  return v;
}

}  // namespace

template <int D>
void Multilevel<D>::clear_chunk(std::int64_t chunk) {
  float* const grid = restricted_.data() + chunk * correction_.size();
  const auto k = index(chunk);
  if (touched_begin_[k] < touched_end_[k])
    std::fill(grid + touched_begin_[k], grid + touched_end_[k], 0.0F);
}

template <int D>
void Multilevel<D>::restrict_chunk(std::int64_t chunk, const float* r, std::int64_t first,
                                   std::int64_t last) {
  const TransferView transfer = view(place_, grid_.finest().shape());
  float* const grid = restricted_.data() + chunk * correction_.size();
  const std::int64_t middle = std::clamp(velocities_, first, last);
  multilevel_kernels().restrict_to[D - 2](transfer, r, grid, first, middle);
  if (middle < last)
    multilevel_kernels().restrict_curl[D - 2](
        transfer, {half_length_.data() - velocities_, slopes_.data()}, r, grid, middle, last);
}

template <int D>
double Multilevel<D>::cycle() {
  const GridShape<D>& shape = grid_.finest().shape();
  float* const sum = correction_.data();  // first P^T r, then e
  correction_.fill(0.0F);
  for (std::int64_t chunk = 0; chunk < chunks(); ++chunk) {
    const float* const part = restricted_.data() + chunk * correction_.size();
    const auto k = index(chunk);
    for (std::int64_t i = touched_begin_[k]; i < touched_end_[k]; ++i) sum[i] += part[i];
  }
  ranks_->sum(std::span(sum, index(correction_.size())));
  // What arrived at a ghost belongs to the point that it copies.
  for (int c = 0; c < D; ++c) {
    if (!shape.periodic[index(c)]) continue;
    const std::int64_t below = shape.stride(c) * SlicedRows<D>::stride;
    const std::int64_t line = below * (shape.points(c) + 2);
    for (std::int64_t begin = 0; begin < correction_.size(); begin += line)
      for (std::int64_t i = 0; i < below; ++i) {
        float* const last = sum + begin + below * (shape.points(c) + 1) + i;
        sum[begin + below + i] += *last;
        *last = 0.0F;
      }
  }
  float* const b = grid_.b();
  for_each_point(shape, [&](const auto& point) {
    const std::int64_t n = shape.number_of(point);
    for (int c = 0; c < D; ++c) b[c * shape.pitch() + n] = sum[n * SlicedRows<D>::stride + c];
  });
  grid_.cycle();
  const float* const x = grid_.x();
  double work = 0.0;
  for_each_point(shape, [&](const auto& point) {
    const std::int64_t n = shape.number_of(point);
    for (int c = 0; c < D; ++c)
      work += static_cast<double>(b[c * shape.pitch() + n]) *
              static_cast<double>(x[c * shape.pitch() + n]);
  });
  for (std::int64_t n = 0; n < shape.total(); ++n)
    for (int c = 0; c < D; ++c) sum[n * SlicedRows<D>::stride + c] = x[c * shape.pitch() + n];
  return work;
}

template <int D>
void Multilevel<D>::interpolate(const float* z, float* p, float beta, std::int64_t first,
                                std::int64_t last) const {
  const TransferView transfer = view(place_, grid_.finest().shape());
  const std::int64_t middle = std::clamp(velocities_, first, last);
  multilevel_kernels().interpolate[D - 2](transfer, correction_.data(), z, p, beta, first, middle);
  if (middle < last)
    multilevel_kernels().interpolate_curl[D - 2](
        transfer, {half_length_.data() - velocities_, slopes_.data()}, correction_.data(), z, p,
        beta, middle, last);
}

template <int D>
std::int64_t Multilevel<D>::bytes() const {
  return grid_.bytes() +
         (half_length_.size() + place_.size() + restricted_.size() + correction_.size()) *
             static_cast<std::int64_t>(sizeof(float));
}

template <int D>
void Multilevel<D>::save(StateWriter& out) const {
  if (grid_.empty()) return;
  const GridOperator<D>& a = grid_.finest();
  std::vector<std::int64_t> shape(a.shape().cells.begin(), a.shape().cells.end());
  for (const bool periodic : a.shape().periodic) shape.push_back(periodic ? 1 : 0);
  shape.push_back(grid_.null_translations() ? 1 : 0);
  out.write("grid_shape", shape);
  out.write("grid_blocks",
            std::vector<double>(a.blocks().data(), a.blocks().data() + a.blocks().size()));
  out.write("grid_state",
            std::vector<double>{shift_, stiffness_time_, fresh_rate_, last_rate_, ties_});
  out.write("grid_low", std::vector<double>(a.shape().low.x.begin(), a.shape().low.x.end()));
  out.write("grid_length",
            std::vector<double>(a.shape().length.x.begin(), a.shape().length.x.end()));
}

template <int D>
void Multilevel<D>::load(const StateReader& in) {
  if (!in.has("grid_shape")) return;
  const std::vector<std::int64_t> saved = in.read_integers("grid_shape");
  if (saved.size() != 2 * D + 1)
    throw IoError("the grid of the checkpoint's solver has another dimension");
  typename GridShape<D>::Index cells{};
  std::array<bool, index(D)> periodic{};
  for (std::size_t c = 0; c < D; ++c) {
    cells[c] = saved[c];
    periodic[c] = saved[D + c] != 0;
  }
  Vec<D> low, length;
  std::copy_n(in.read_doubles("grid_low").begin(), D, low.x.begin());
  std::copy_n(in.read_doubles("grid_length").begin(), D, length.x.begin());
  GridOperator<D> a(GridShape<D>(low, length, cells, periodic));
  const std::vector<double> blocks = in.read_doubles("grid_blocks");
  if (static_cast<std::int64_t>(blocks.size()) != a.blocks().size())
    throw IoError("the grid of the checkpoint's solver has another size than its shape says");
  std::transform(blocks.begin(), blocks.end(), a.blocks().data(),
                 [](double v) { return static_cast<float>(v); });
  grid_.set_up(std::move(a), saved[2 * D] != 0);
  const std::vector<double> state = in.read_doubles("grid_state");
  shift_ = state.at(0);
  stiffness_time_ = state.at(1);
  fresh_rate_ = state.at(2);
  last_rate_ = state.at(3);
  ties_ = state.at(4);
}

template class Multilevel<2>;
template class Multilevel<3>;

}  // namespace odpd
