#include "odpd/analysis/density_residual.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace odpd {

namespace {
template <std::size_t N>
std::size_t product(const std::array<std::int64_t, N>& counts) {
  std::size_t n = 1;
  for (const std::int64_t c : counts) n *= static_cast<std::size_t>(c);
  return n;
}
}  // namespace

template <int D>
DensityResidual<D>::DensityResidual(ObserverSettings settings,
                                    std::array<std::int64_t, static_cast<std::size_t>(D)> bins,
                                    const Scene<D>& scene)
    : Observer<D>(std::move(settings)),
      bins_(bins),
      scene_(scene),
      bin_volume_(scene.fluid_volume() / static_cast<double>(product(bins))),
      average_(product(bins)) {}

template <int D>
double DensityResidual<D>::thesis_residual(std::span<const double> counts) const {
  const auto n_bins = static_cast<double>(counts.size());
  const double mean = std::accumulate(counts.begin(), counts.end(), 0.0) / n_bins;
  double sum = 0.0;
  for (const double count : counts) sum += (count - mean) * (count - mean);
  return std::sqrt(sum / n_bins) / bin_volume_;
}

template <int D>
void DensityResidual<D>::measure(const Clock&, const Particles<D>& particles,
                                 const StepRecord<D>& record) {
  const Vec<D> low = scene_.fluid_low();
  const Vec<D> high = scene_.fluid_high();
  std::vector<double> counts(average_.width(), 0.0);
  for (std::size_t i = 0; i < record.start.position.size(); ++i) {
    if (!particles.is_free(i)) continue;
    std::int64_t bin = 0;
    for (int c = D - 1; c >= 0; --c) {
      const std::int64_t n = bins_[static_cast<std::size_t>(c)];
      const double x =
          (record.start.position[i][c] - low[c]) / (high[c] - low[c]) * static_cast<double>(n);
      bin = bin * n + std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(x)), 0, n - 1);
    }
    counts[static_cast<std::size_t>(bin)] += 1.0;
  }
  average_.add(counts);
  const double thesis = thesis_residual(counts);
  newest_ = {thesis / std::sqrt(static_cast<double>(counts.size())), thesis};
}

template <int D>
void DensityResidual<D>::add_results(Results& results) const {
  if (average_.samples() == 0) return;
  std::vector<double> means(average_.width());
  for (std::size_t b = 0; b < means.size(); ++b) means[b] = average_.mean(b);
  const double thesis = thesis_residual(means);
  const double error =
      average_.jackknife_error([this](const std::vector<double>& m) { return thesis_residual(m); });
  const double to_paper = 1.0 / std::sqrt(static_cast<double>(means.size()));
  const std::string& name = this->settings().name;
  results.scalars.push_back({name + ".paper", thesis * to_paper, error * to_paper});
  results.scalars.push_back({name + ".thesis", thesis, error});
}

template class DensityResidual<2>;
template class DensityResidual<3>;

}  // namespace odpd
