#include "odpd/analysis/waves.h"

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

}  // namespace

template <int D>
Waves<D>::Waves(std::vector<std::int64_t> numbers, std::vector<int> axes, double edge)
    : numbers_(std::move(numbers)), axes_(std::move(axes)), edge_(edge) {
  for (std::size_t wave = 0; wave < numbers_.size(); ++wave)
    for (const int axis : axes_)
      for (int c = 0; c < D; ++c)
        for (const bool sine : {false, true})
          if (c != axis) modes_.push_back({wave, axis, c, sine});
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
  for (; first < last; first += lanes) {
    const std::size_t there = std::min(lanes, last - first);
    for (std::size_t a = 0; a < axes_.size(); ++a) {
      Lanes cosine_1{}, sine_1{}, cosine, sine{};
      std::array<Lanes, D - 1> across{};  // components, zero where there is no particle
      cosine.fill(1.0);
      for (std::size_t lane = 0; lane < there; ++lane) {
        const double angle = 2.0 * std::numbers::pi * position[first + lane][axes_[a]] / edge_;
        cosine_1[lane] = std::cos(angle);
        sine_1[lane] = std::sin(angle);
        std::size_t at = 0;
        for (int c = 0; c < D; ++c)
          if (c != axes_[a]) across[at++][lane] = vector[first + lane][c];
      }
      std::int64_t number = 0;
      for (std::size_t wave = 0; wave < numbers_.size(); ++wave) {
        for (; number < numbers_[wave]; ++number)
          for (std::size_t lane = 0; lane < lanes; ++lane) {
            const double turned = cosine[lane] * cosine_1[lane] - sine[lane] * sine_1[lane];
            sine[lane] = sine[lane] * cosine_1[lane] + cosine[lane] * sine_1[lane];
            cosine[lane] = turned;
          }
        Lanes* of_mode = part.data() + (wave * axes_.size() + a) * 2 * (D - 1);
        for (const Lanes& component : across) {
          Lanes& with_cosine = *of_mode++;
          Lanes& with_sine = *of_mode++;
          for (std::size_t lane = 0; lane < lanes; ++lane) {
            with_cosine[lane] += cosine[lane] * component[lane];
            with_sine[lane] += sine[lane] * component[lane];
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

template <int D>
std::vector<double> Waves<D>::friction(const Particles<D>& particles,
                                       const std::vector<Vec<D>>& position,
                                       const PairNetwork<D>& network) const {
  std::vector<double> sum(numbers_.size(), 0.0);
  for (const Mode& mode : modes_) {
    const std::vector<Vec<D>> phi = shape(mode, position);
    double power = 0.0;
    for (std::size_t edge = 0; edge < index(network.size()); ++edge) {
      if (!network.counts(edge)) continue;
      const Vec<D> slip = phi[index(network.i[edge])] - phi[index(network.j[edge])];
      const double along = dot(slip, network.e[edge]);
      power += network.zeta_par[edge] * along * along;
      if (network.transverse) power += network.zeta_perp[edge] * (dot(slip, slip) - along * along);
    }
    sum[mode.wave] += power / static_cast<double>(modes_per_wave());
  }
  particles.ranks().sum(sum);
  return sum;
}

template class Waves<2>;
template class Waves<3>;

}  // namespace odpd
