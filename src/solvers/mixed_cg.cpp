#include "mixed_cg.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "block_inverse.h"
#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"
#include "odpd/solvers/backends.h"
#include "odpd/solvers/preconditioner.h"

namespace odpd {

namespace {

// A recursive residual this small beside the last double one is mostly rounding of the operator.
constexpr double trusted_fall = 1e-4;
// Aimed at, in units of the tolerance: the double residual may be a little larger than the recursive one.
constexpr double aim = 0.8;
// Iterations without halving the residual after which the grid is given up, and then single precision. A box two
// cutoffs thin, which takes block-Jacobi thousands of iterations, needs 260.
constexpr std::int64_t patience_with_grid = 200, patience = 1000;
// After so many the system is badly conditioned, and the recursive residual not trusted at any tolerance.
constexpr std::int64_t unsuspicious = 500;
// Fewer iterations say nothing of the rate.
constexpr std::int64_t fewest_for_rate = 8;
// `auto` (docs/performance.md has the measurements): the grid costs two to three times as much per iteration. Below so many
// nodes, and where the shift exceeds this part of the mean friction of a node, block-Jacobi alone is as fast.
template <int D>
constexpr std::int64_t fewest_for_grid = D == 2 ? 500 : 5000;
constexpr double shift_without_grid = 0.02;
constexpr const char* no_grid_for_null_motions =
    "preconditioner multilevel knows no null motions but translations: block-Jacobi instead, while "
    "particles are free to turn";

}  // namespace

template <int D>
void MixedCg<D>::set_up(const System& system) {
  system_ = &system;
  spins_ = dynamic_cast<const SpinResistance<D>*>(&system);
  in_front_ = spins_ != nullptr ? spins_->spins() : 0;
  const System& velocities = spins_ != nullptr ? spins_->velocities().system() : system;
  rigid_ = dynamic_cast<const RigidResistance<D>*>(&velocities);
  resistance_ =
      rigid_ != nullptr ? &rigid_->mobile() : &dynamic_cast<const Resistance<D>&>(velocities);
  share_ = resistance_->share();
  rows_.pack(*resistance_);
  if (spins_ != nullptr) {
    spin_rows_.pack(*spins_, rows_);
  } else {
    spin_rows_.clear();
  }
  note_.clear();
  with_grid_ = preconditioner_ == "multilevel" || (preconditioner_ == "auto" && grid_pays());
  if (with_grid_ && !system.null_motions().empty()) {
    if (preconditioner_ == "multilevel") note_ = no_grid_for_null_motions;
    with_grid_ = false;
  }
  for (FloatArray* v : {&r_, &z_, &p_, &q_, &x_}) v->resize(places() * stride);
  residual_.resize(index(system.size()));
  sums_.resize(index(2 * blocks()));
  invert_diagonal();
  if (rigid_ != nullptr) {
    bodies_.pack(*rigid_, rows_);
  } else {
    bodies_.clear();
  }
  if (with_grid_) grid_.set_up(*resistance_, rows_, rigid_, spins_);
  local_ = grid_.local();
  t_.resize(with_grid_ && local_.size() > 2 ? places() * stride : 0);
  if (spins_ != nullptr) t_.fill(0.0F);  // nobody else writes to empty places of spins
}

template <int D>
bool MixedCg<D>::grid_pays() const {
  if (share_.count(resistance_->nodes()) < fewest_for_grid<D>) return false;
  // Trace of some nodes' blocks, and how many: their mean need not be exact.
  std::array<double, 2> sum{};
  constexpr std::size_t sample = 1000;
  const auto blocks = resistance_->diagonal();
  for (std::size_t n = 0; n < blocks.size();
       n += std::max<std::size_t>(1, blocks.size() / sample)) {
    if (!share_.owns(n)) continue;
    for (std::size_t c = 0; c < D; ++c) sum[0] += blocks[n][c * D + c];
    sum[1] += 1.0;
  }
  share_.ranks->sum(std::span(sum));
  const double mean = sum[0] / (D * sum[1]) - resistance_->shift();
  return resistance_->shift() < shift_without_grid * mean;
}

template <int D>
void MixedCg<D>::invert_diagonal() {
  inverse_.resize(places() * triangle);
  const std::int64_t none = system_->nodes();
  std::atomic<std::int64_t> first_bad{none};
  parallel_for(rows_.places(), [&](std::int64_t place) {
    const std::int32_t node = rows_.node_of_place()[index(place)];
    typename Resistance<D>::Block m{};  // zero for constituents of bodies
    if (node >= 0 && !is_constituent(node)) m = inverse_of(resistance_->diagonal()[index(node)]);
    if (std::isnan(m[0]) && share_.owns(std::int64_t{node})) lower(first_bad, unknown_of(place));
    set_inverse(place, m);
  });
  if (spins_ != nullptr) {
    for (std::int64_t place = rows_.places(); place < places(); ++place) set_inverse(place, {});
    spin_blocks_.pack(*spins_, rows_, [&](std::int64_t place, const auto& m) {
      if (std::isnan(m[0])) {
        const std::int32_t node = unknown_of(place);
        if (place < rows_.places() && share_.owns(node - in_front_)) lower(first_bad, node);
      }
      set_inverse(place, m);
    });
  } else {
    spin_blocks_.clear();
  }
  share_.ranks->together([&] {
    if (first_bad < none) reject_block(first_bad);
  });
}

template <int D>
void MixedCg<D>::set_inverse(std::int64_t place, const typename Resistance<D>::Block& inverse) {
  float* out =
      inverse_.data() + place / slice_places * slice_places * triangle + place % slice_places;
  for (std::size_t row = 0; row < D; ++row)
    for (std::size_t col = row; col < D; ++col, out += slice_places)
      *out = static_cast<float>(inverse[row * D + col]);
}

/// residual_ := Pi (b - A x); returns its norm.
template <int D>
double MixedCg<D>::true_residual(std::span<const double> b, std::span<const double> x) {
  const auto own = system_->share().part(x, D);
  if (share_.ranks->all(std::all_of(own.begin(), own.end(), [](double v) { return v == 0.0; }))) {
    std::copy(b.begin(), b.end(), residual_.begin());
  } else {
    system_->apply(x, residual_);
    parallel_for(system_->size(),
                 [&](std::int64_t i) { residual_[index(i)] = b[index(i)] - residual_[index(i)]; });
  }
  system_->project(residual_);
  return system_->norm(residual_);
}

template <int D>
void MixedCg<D>::load_residual(double scale) {
  parallel_for(places(), [&](std::int64_t place) {
    const std::int32_t node = unknown_of(place);
    float* const r = r_.data() + place * stride;
    for (std::int64_t c = 0; c < stride; ++c)
      r[c] = node >= 0 && c < D ? static_cast<float>(residual_[index(node * D + c)] / scale) : 0.0F;
  });
  bodies_.scatter(std::span(residual_).subspan(index(in_front_ * D)), scale, r_.data());
}

/// x += scale d, d = 0.
template <int D>
void MixedCg<D>::flush(std::span<double> x, double scale) {
  bodies_.add_to(x_.data(), scale, x.subspan(index(in_front_ * D)));
  parallel_for(places(), [&](std::int64_t place) {
    const std::int32_t node = unknown_of(place);
    float* const d = x_.data() + place * stride;
    for (std::int64_t c = 0; c < stride; ++c) {
      if (node >= 0 && c < D) x[index(node * D + c)] += scale * static_cast<double>(d[c]);
      d[c] = 0.0F;
    }
  });
}

/// Of sums_, on all ranks.
template <int D>
double MixedCg<D>::sum_of_blocks() {
  double sum = 0.0;
  for (std::int64_t block = 0; block < blocks(); ++block)
    if (owns(block)) sum += sums_[index(block)];
  return share_.ranks->sum(sum);
}

/// out = A in of a block of velocities and of their spins, wherever these stand; returns its part of in . out.
template <int D>
double MixedCg<D>::multiply(const FloatArray& in, FloatArray& out, std::int64_t block) {
  const std::int64_t first = block * block_places, last = std::min(end_of(block), rows_.places());
  if (first >= last) return 0.0;
  const double work = rows_.product(in.data(), out.data(), first, last);
  return spin_rows_.empty() ? work : work + spin_rows_.product(in.data(), out.data(), first, last);
}

/// q = A p; returns p . q.
template <int D>
double MixedCg<D>::product() {
  parallel_blocks(blocks(),
                  [&](std::int64_t block) { sums_[index(block)] = multiply(p_, q_, block); });
  const double sum = sum_of_blocks();
  bodies_.project(q_.data());
  if (system_->holds_centre_of_mass()) project(q_);
  return sum;
}

/// d += alpha p, r -= alpha q; z = D^-1 r and P^T r. Returns r . r and r . D^-1 r.
template <int D>
CgSums MixedCg<D>::update(double alpha) {
  parallel_blocks(Multilevel<D>::chunks(), [&](std::int64_t chunk) {
    if (with_grid_) grid_.clear_chunk(chunk);
    const std::int64_t end = chunk_begin(places(), chunk + 1);
    for (std::int64_t first = chunk_begin(places(), chunk); first < end; first += block_places) {
      const std::int64_t last = std::min(end, first + block_places);
      const CgSums sums = multilevel_kernels().update[D - 2](
          inverse_.data(), static_cast<float>(alpha), p_.data(), q_.data(), x_.data(), r_.data(),
          z_.data(), first, last);
      sums_[index(2 * (first / block_places))] = sums.rr;
      sums_[index(2 * (first / block_places) + 1)] = sums.rz;
      if (with_grid_ && owns(first / block_places))
        grid_.restrict_chunk(chunk, r_.data(), first, last);
    }
  });
  std::array<double, 2> total{};
  for (std::int64_t block = 0; block < blocks(); ++block) {
    if (!owns(block)) continue;
    total[0] += sums_[index(2 * block)];
    total[1] += sums_[index(2 * block + 1)];
  }
  share_.ranks->sum(std::span(total));
  total[1] += spin_blocks_.couple(r_.data(), z_.data());
  return {total[0], total[1] + bodies_.solve(r_.data(), z_.data())};
}

/// out = keep z - step D^-1 A in, z = D^-1 r; returns z . A in.
template <int D>
double MixedCg<D>::local_step(double keep, double step, const FloatArray& in, FloatArray& out) {
  const auto relax = [&](std::int64_t block) {
    sums_[index(block)] = multilevel_kernels().local[D - 2](
        inverse_.data(), static_cast<float>(keep), static_cast<float>(step), z_.data(), out.data(),
        block * block_places, end_of(block));
  };
  if (bodies_.empty() && spins_ == nullptr) {
    parallel_blocks(blocks(), [&](std::int64_t block) {
      multiply(in, out, block);
      relax(block);
    });
  } else {
    parallel_blocks(blocks(), [&](std::int64_t block) { multiply(in, out, block); });
    bodies_.gather(out.data());
    spin_blocks_.gather(out.data());
    parallel_blocks(blocks(), relax);
    bodies_.subtract(static_cast<float>(step), out.data());
    spin_blocks_.subtract(static_cast<float>(step), out.data());
  }
  return sum_of_blocks();
}

/// With z = D^-1 r and r . z given: the local part of the preconditioner in q, the grid's in its correction. Returns the product
/// of r and both.
template <int D>
double MixedCg<D>::precondition(double rz) {
  if (!with_grid_) return rz;
  const LocalPart& c = local_;
  // From the inside, Horner's rule; the last step writes to q.
  std::size_t k = c.size() - 1;
  FloatArray *out = k % 2 == 1 ? &q_ : &t_, *other = k % 2 == 1 ? &t_ : &q_;
  double step = c[k], zau = local_step(c[k - 1], step, z_, *out);
  for (--k; k > 0; --k) {
    std::swap(out, other);
    step = 1.0;
    zau = local_step(c[k - 1], step, *other, *out);
  }
  const double work = c[0] * rz - step * zau;
  return work + grid_.cycle();
}

/// p = preconditioned r + beta p.
template <int D>
void MixedCg<D>::turn(double beta) {
  const auto b = static_cast<float>(beta);
  parallel_blocks(blocks(), [&](std::int64_t block) {
    const std::int64_t first = block * block_places, last = end_of(block);
    if (with_grid_) {
      grid_.interpolate(q_.data(), p_.data(), b, first, last);
    } else {
      for (std::int64_t i = first * stride; i < last * stride; ++i)
        p_.data()[i] = z_.data()[i] + b * p_.data()[i];
    }
  });
  if (with_grid_) bodies_.project(p_.data());
  if (system_->holds_centre_of_mass()) project(p_);
}

/// v := Pi v over the occupied places.
template <int D>
void MixedCg<D>::project(FloatArray& v) {
  std::array<double, D + 1> mean{};  // and the nodes
  for (std::int64_t place = 0; place < rows_.places(); ++place)
    if (rows_.node_of_place()[index(place)] >= 0 && owns(place / block_places)) {
      for (std::int64_t c = 0; c < D; ++c)
        mean[index(c)] += static_cast<double>(v.data()[place * stride + c]);
      mean.back() += 1.0;
    }
  share_.ranks->sum(std::span(mean));
  for (std::size_t c = 0; c < D; ++c) mean[c] /= mean.back();
  parallel_for(rows_.places(), [&](std::int64_t place) {
    if (rows_.node_of_place()[index(place)] < 0) return;
    for (std::int64_t c = 0; c < D; ++c)
      v.data()[place * stride + c] -= static_cast<float>(mean[index(c)]);
  });
}

template <int D>
auto MixedCg<D>::iterate(std::span<const double> b, std::span<double> x, double goal,
                         std::int64_t most_iterations, Solver::Attempt& result) -> Outcome {
  const double scale = true_residual(b, x);
  first_residual_ = scale;
  if (scale <= goal) return Outcome::reached;
  if (!std::isfinite(scale)) {
    result.failure = no_longer_finite;
    return Outcome::gave_up;
  }
  x_.fill(0.0F);
  p_.fill(0.0F);
  q_.fill(0.0F);
  load_residual(scale);
  CgSums sums = update(0.0);
  double rho = precondition(sums.rz), beta = 0.0;
  double updated = 1.0;  // residual at the last double one, in units of scale as all below
  double smallest = 1.0;
  std::int64_t since_smallest = 0;
  while (result.iterations < most_iterations) {
    ++result.iterations;
    turn(beta);
    const double curvature = product();
    if (!(rho > 0.0) || !(curvature > 0.0)) {
      flush(x, scale);
      result.failure = std::isnan(rho) || std::isnan(curvature) ? no_longer_finite : not_definite;
      return Outcome::gave_up;
    }
    sums = update(rho / curvature);
    double norm = std::sqrt(sums.rr);
    const bool reached = norm * scale <= aim * goal;
    if (reached || norm < trusted_fall * updated) {
      flush(x, scale);
      if (reached && goal > trusted_fall * updated * scale && result.iterations < unsuspicious)
        return Outcome::reached;
      norm = true_residual(b, x) / scale;
      if (norm * scale <= goal) return Outcome::reached;
      updated = norm;
      load_residual(scale);
      sums = update(0.0);
    }
    if (norm > divergence) {
      flush(x, scale);
      result.failure = diverged;
      return Outcome::gave_up;
    }
    since_smallest = norm < 0.5 * smallest ? 0 : since_smallest + 1;
    smallest = std::min(smallest, since_smallest == 0 ? norm : smallest);
    if (since_smallest > (with_grid_ ? patience_with_grid : patience)) {
      flush(x, scale);
      result.failure = "the residual falls too slowly";
      return Outcome::gave_up;
    }
    const double before = rho;
    rho = precondition(sums.rz);
    beta = rho / before;
  }
  flush(x, scale);
  return Outcome::out_of_iterations;
}

template <int D>
Solver::Attempt MixedCg<D>::attempt(std::span<const double> b, std::span<double> x,
                                    double tolerance, std::int64_t most_iterations) {
  Solver::Attempt result;
  const double goal = tolerance * system_->norm(b);
  bodies_.settle_unused(b.subspan(index(in_front_ * D)), x.subspan(index(in_front_ * D)));
  guess_.assign(x.begin(), x.end());
  Outcome outcome = iterate(b, x, goal, most_iterations, result);
  if (with_grid_ && outcome == Outcome::gave_up) {
    note_ = "multilevel gave up (" + result.failure + "): block-Jacobi instead";
    with_grid_ = false;
    grid_.note_rate(0.0);  // to be built anew, if it ever served
    result.failure.clear();
    std::copy(guess_.begin(), guess_.end(), x.begin());
    outcome = iterate(b, x, goal, most_iterations, result);
  } else if (with_grid_ && outcome == Outcome::reached && result.iterations >= fewest_for_rate) {
    grid_.note_rate(std::log10(first_residual_ / goal) / static_cast<double>(result.iterations));
  }
  if (outcome == Outcome::gave_up) std::copy(guess_.begin(), guess_.end(), x.begin());
  result.ok = outcome == Outcome::reached;
  return result;
}

template <int D>
std::int64_t MixedCg<D>::memory_bytes() const {
  const std::int64_t floats = inverse_.size() + 5 * r_.size() + t_.size();
  return rows_.bytes() + spin_rows_.bytes() + spin_blocks_.bytes() + bodies_.bytes() +
         (with_grid_ ? grid_.bytes() : 0) + floats * static_cast<std::int64_t>(sizeof(float)) +
         static_cast<std::int64_t>(residual_.size() * sizeof(double));
}

std::unique_ptr<CgEngine> make_mixed_cg(const System& system, const SolverOptions& options) {
  std::unique_ptr<CgEngine> made = std::make_unique<MixedCg<2>>(options);
  if (!made->serves(system)) made = std::make_unique<MixedCg<3>>(options);
  return made->serves(system) ? std::move(made) : nullptr;
}

}  // namespace odpd
