#include "odpd/analysis/waves.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "odpd/core/index.h"
#include "odpd/core/parallel.h"

namespace odpd {

namespace {

constexpr std::int64_t particles_per_sum = 512;

// Some particles side by side, which the compiler makes vectors of; each lane has a sum of its own.
constexpr std::size_t lanes = 8;
using Lanes = std::array<double, lanes>;

struct Turned {
  Lanes cosine, sine;
};

// cos and sin of 2 pi turns, to rounding: Taylor's series for a quarter of the angle, of -pi to pi, which is then doubled
// twice. The library's take three times as long, one by one.
Turned turned(const Lanes& turns) {
  constexpr double to_whole = 0x1.8p52;  // added and taken off again: rounds
  Turned t{};
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const double rest = turns[lane] - ((turns[lane] + to_whole) - to_whole);
    const double angle = 0.5 * std::numbers::pi * rest, x = angle * angle;
    double c = 1.0 / 20922789888000.0, s = -1.0 / 1307674368000.0;
    for (const double n : {-1.0 / 87178291200.0, 1.0 / 479001600.0, -1.0 / 3628800.0, 1.0 / 40320.0,
                           -1.0 / 720.0, 1.0 / 24.0, -1.0 / 2.0, 1.0})
      c = c * x + n;
    for (const double n : {1.0 / 6227020800.0, -1.0 / 39916800.0, 1.0 / 362880.0, -1.0 / 5040.0,
                           1.0 / 120.0, -1.0 / 6.0, 1.0})
      s = s * x + n;
    s *= angle;
    for (int twice = 0; twice < 2; ++twice) {
      const double sine = 2.0 * s * c;
      c = 1.0 - 2.0 * s * s;
      s = sine;
    }
    t.cosine[lane] = c;
    t.sine[lane] = s;
  }
  return t;
}

// From one wave number to a larger one.
void raise(Turned& at, const Turned& one, std::int64_t by) {
  for (; by > 0; --by)
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const double c = at.cosine[lane] * one.cosine[lane] - at.sine[lane] * one.sine[lane];
      at.sine[lane] = at.sine[lane] * one.cosine[lane] + at.cosine[lane] * one.sine[lane];
      at.cosine[lane] = c;
    }
}

}  // namespace

template <int D>
Waves<D>::Waves(std::vector<std::int64_t> numbers, std::vector<int> axes, double edge,
                bool longitudinal)
    : numbers_(std::move(numbers)),
      axes_(std::move(axes)),
      edge_(edge),
      longitudinal_(longitudinal) {
  for (std::size_t wave = 0; wave < numbers_.size(); ++wave)
    for (const int axis : axes_)
      for (int c = 0; c < D; ++c)
        for (const bool sine : {false, true})
          if (longitudinal || c != axis) modes_.push_back({wave, axis, c, sine});
}

template <int D>
std::vector<std::string> Waves<D>::names(const std::string& prefix) const {
  std::vector<std::string> names;
  for (const Mode& mode : modes_)
    names.push_back(fmt::format("{}_{}_{}{}_{}", prefix, numbers_[mode.wave], "xyz"[mode.axis],
                                "xyz"[mode.component], mode.sine ? "sin" : "cos"));
  return names;
}

template <int D>
double Waves<D>::k(std::size_t wave) const {
  return 2.0 * std::numbers::pi * static_cast<double>(numbers_[wave]) / edge_;
}

template <int D>
std::vector<Vec<D>> Waves<D>::shape(const Mode& mode, const std::vector<Vec<D>>& position) const {
  std::vector<Vec<D>> phi(position.size());
  parallel_for(std::ssize(phi), [&](std::int64_t particle) {
    const auto i = index(particle);
    const double angle = k(mode.wave) * position[i][mode.axis];
    phi[i][mode.component] = mode.sine ? std::sin(angle) : std::cos(angle);
  });
  return phi;
}

// Of the particles first to last, into one number per mode. Waves follow from the longest by multiplication.
template <int D>
void Waves<D>::add_sums(std::size_t first, std::size_t last, const std::vector<Vec<D>>& position,
                        const std::vector<Vec<D>>& vector, double* sum) const {
  std::vector<Lanes> part(modes_.size(), Lanes{});
  const std::size_t components = longitudinal_ ? D : D - 1;
  for (; first < last; first += lanes) {
    const std::size_t there = std::min(lanes, last - first);
    for (std::size_t a = 0; a < axes_.size(); ++a) {
      Lanes turns{};
      std::array<Lanes, D> component{};  // zero where there is no particle
      for (std::size_t lane = 0; lane < there; ++lane) {
        turns[lane] = position[first + lane][axes_[a]] / edge_;
        std::size_t at = 0;
        for (int c = 0; c < D; ++c)
          if (longitudinal_ || c != axes_[a]) component[at++][lane] = vector[first + lane][c];
      }
      const Turned one = turned(turns);
      Turned wave_at = one;
      std::int64_t number = 1;
      for (std::size_t wave = 0; wave < numbers_.size(); ++wave) {
        raise(wave_at, one, numbers_[wave] - number);
        number = numbers_[wave];
        Lanes* of_mode = part.data() + (wave * axes_.size() + a) * 2 * components;
        for (std::size_t c = 0; c < components; ++c) {
          Lanes& with_cosine = *of_mode++;
          Lanes& with_sine = *of_mode++;
          for (std::size_t lane = 0; lane < lanes; ++lane) {
            with_cosine[lane] += wave_at.cosine[lane] * component[c][lane];
            with_sine[lane] += wave_at.sine[lane] * component[c][lane];
          }
        }
      }
    }
  }
  for (std::size_t m = 0; m < part.size(); ++m)
    for (const double lane : part[m]) sum[m] += lane;
}

template <int D>
std::vector<double> Waves<D>::sums(const Particles<D>& particles,
                                   const std::vector<Vec<D>>& position,
                                   const std::vector<Vec<D>>& vector) const {
  const Share own = particles.owned();
  const auto first = index(own.first);
  const std::int64_t n = own.end(std::ssize(position)) - own.first;
  const std::size_t width = modes_.size();
  std::vector<double> part(index((n + particles_per_sum - 1) / particles_per_sum) * width, 0.0);
  parallel_ranges(n, particles_per_sum, [&](std::int64_t begin, std::int64_t end) {
    add_sums(first + index(begin), first + index(end), position, vector,
             part.data() + index(begin / particles_per_sum) * width);
  });
  std::vector<double> total(width, 0.0);
  for (std::size_t at = 0; at < part.size(); ++at) total[at % width] += part[at];
  own.ranks->sum(total);
  return total;
}

// Of all modes of a k along an axis together: both phases of phi_i - phi_j square to 2 - 2 cos(k (r_i - r_j)), and components
// e_c^2 sum to 1 - e_axis^2.
template <int D>
std::vector<double> Waves<D>::friction(const Particles<D>& particles,
                                       const PairNetwork<D>& network) const {
  std::vector<double> sum(numbers_.size(), 0.0);
  const std::size_t edges = index(network.size());
  for (const int axis : axes_)
    for (std::size_t first = 0; first < edges; first += lanes) {
      Lanes turns{}, weight{};
      for (std::size_t lane = 0; lane < std::min(lanes, edges - first); ++lane) {
        const std::size_t edge = first + lane;
        if (!network.counts(edge)) continue;
        const double along = network.e[edge][axis], rest = 1.0 - along * along;
        turns[lane] = network.r[edge] * along / edge_;
        weight[lane] = network.zeta_par[edge] * rest;
        if (network.transverse) weight[lane] += network.zeta_perp[edge] * (D - 1 - rest);
      }
      const Turned one = turned(turns);
      Turned wave_at = one;
      std::int64_t number = 1;
      for (std::size_t wave = 0; wave < numbers_.size(); ++wave) {
        raise(wave_at, one, numbers_[wave] - number);
        number = numbers_[wave];
        for (std::size_t lane = 0; lane < lanes; ++lane)
          sum[wave] += weight[lane] * (1.0 - wave_at.cosine[lane]);
      }
    }
  particles.ranks().sum(sum);
  for (double& power : sum) power *= 1.0 / static_cast<double>(axes_.size() * (D - 1));
  return sum;
}

template class Waves<2>;
template class Waves<3>;

}  // namespace odpd
