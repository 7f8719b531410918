#include "odpd/analysis/surface_tension.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/analysis/observer_keys.h"
#include "odpd/core/index.h"
#include "odpd/core/parallel.h"

namespace odpd {

namespace {

// Columns of a sample: gamma by stress, and [U(x) - U(-x)]/(4 A x); exp(-[U(x) - U(0)]/kT) for x and -x, the square of
// [U(x) - U(0)]/kT; the pressures.
enum TensionColumn : std::size_t {
  by_stress,
  by_energy,
  exp_up,
  exp_down,
  cost,
  p_n,
  p_t,
  tension_columns
};

template <int D>
void refuse_other_scenes(const ObserverEntry<D>& entry) {
  const Scene<D>& scene = entry.scene;
  const Box<D>& box = scene.box();
  const bool plain = box.periodic_directions() == D && !box.shear &&
                     scene.settings().bodies.empty() && !scene.settings().driven();
  if (!plain)
    entry.config.fail("kind",
                      "takes a slab at rest in a periodic box, without bodies: stretching the box "
                      "would bend a body, and a wall or a flow has a stress of its own");
}

}  // namespace

template <int D>
typename SurfaceTension<D>::Stretched SurfaceTension<D>::stretched(double x) const {
  Vec<D> factor;
  Box<D> box = scene_.box();
  for (int c = 0; c < D; ++c) {
    factor[c] = c == tension_.axis ? 1.0 / (1.0 + x) : std::pow(1.0 + x, 1.0 / (D - 1));
    box.size[c] *= factor[c];
  }
  return {factor, box, PairList<D>(box, scene_.model().cutoff(), 0.0)};
}

template <int D>
SurfaceTension<D>::SurfaceTension(ObserverSettings settings, SurfaceTensionSettings tension,
                                  const Scene<D>& scene)
    : Observer<D>(std::move(settings), tension_columns),
      tension_(tension),
      scene_(scene),
      area_(scene.box().volume() / scene.box().size[tension.axis]),
      stretched_{stretched(tension.strain), stretched(-tension.strain)} {}

template <int D>
std::unique_ptr<Observer<D>> SurfaceTension<D>::make(const ObserverEntry<D>& entry) {
  refuse_other_scenes(entry);
  const Vec<D>& size = entry.scene.box().size;
  ObserverSettings settings = entry.settings(5);
  int longest = 0;
  for (int c = 1; c < D; ++c)
    if (size[c] > size[longest]) longest = c;
  SurfaceTensionSettings tension;
  tension.axis = read_direction<D>(entry.config, "axis", longest);
  tension.strain = entry.config.positive("strain", tension.strain);
  const double shrinks =
      std::min(std::pow(1.0 - tension.strain, 1.0 / (D - 1)), 1.0 / (1.0 + tension.strain));
  const double least = 2.0 * entry.scene.model().cutoff() / shrinks;
  const double shortest = *std::min_element(size.x.begin(), size.x.end());
  if (tension.strain > 0.1 || shortest < least)
    entry.config.fail(
        "strain",
        fmt::format("is {}: at most 0.1, and every edge of the box must stay two cutoffs long when "
                    "it is stretched by so much (now {}, {:.6g} is needed)",
                    tension.strain, shortest, least));
  return std::make_unique<SurfaceTension<D>>(std::move(settings), tension, entry.scene);
}

template <int D>
double SurfaceTension<D>::energy(Stretched& to, const Particles<D>& particles,
                                 const std::vector<Vec<D>>& positions) const {
  std::vector<Vec<D>> moved = positions;
  for (Vec<D>& r : moved) {
    for (int c = 0; c < D; ++c) r[c] *= to.factor[c];
    to.box.wrap(r);
  }
  to.list.update(moved, particles.owned());
  PairNetwork<D> network;
  scene_.model().write_edges(to.list, to.box, moved, particles, network);
  network.owned = particles.owned();
  return network.energy();
}

template <int D>
void SurfaceTension<D>::measure(const Clock&, const Particles<D>& particles,
                                const StepRecord<D>& record) {
  const PairNetwork<D>& network = record.start.network;
  const Share own = particles.owned();
  std::vector<double> virial_n(index(network.size())), virial_t(index(network.size()));
  for (std::size_t k = 0; k < virial_n.size(); ++k) {
    if (!network.counts(k)) continue;
    const Vec<D> arm = network.r[k] * network.e[k], push = network.push(k);
    virial_n[k] = arm[tension_.axis] * push[tension_.axis];
    virial_t[k] = (dot(arm, push) - virial_n[k]) / (D - 1);
  }
  const double sum_n = own.ranks->sum(fixed_sum(virial_n)),
               sum_t = own.ranks->sum(fixed_sum(virial_t));
  const double u = network.energy(), kT = scene_.largest_kT();
  const double up = energy(stretched_[0], particles, record.start.position),
               down = energy(stretched_[1], particles, record.start.position);
  const double ideal = static_cast<double>(particles.free_count()) * kT,
               volume = scene_.box().volume();
  std::vector<double> sample(tension_columns, 0.0);
  sample[by_stress] = (sum_n - sum_t) / (2.0 * area_);
  sample[by_energy] = (up - down) / (4.0 * area_ * tension_.strain);
  if (kT > 0.0) {
    sample[exp_up] = std::exp((u - up) / kT);
    sample[exp_down] = std::exp((u - down) / kT);
    sample[cost] = (up - u) / kT * ((up - u) / kT);
  }
  sample[p_n] = (ideal + sum_n) / volume;
  sample[p_t] = (ideal + sum_t) / volume;
  this->add(std::move(sample));
}

template <int D>
double SurfaceTension<D>::test_area(const std::vector<double>& means) const {
  const double kT = scene_.largest_kT();
  if (kT == 0.0) return means[by_energy];
  return kT * std::log(means[exp_down] / means[exp_up]) / (4.0 * area_ * tension_.strain);
}

template <int D>
void SurfaceTension<D>::add_results(Results& results) const {
  const BlockAverage& average = this->average();
  std::vector<double> means;
  for (std::size_t k = 0; k < average.width(); ++k) means.push_back(average.mean(k));
  results.scalars.push_back(this->mean_of(by_stress, this->named("stress")));
  results.scalars.push_back(
      {this->named("test_area"), test_area(means),
       average.jackknife_error([this](const std::vector<double>& m) { return test_area(m); })});
  results.scalars.push_back(this->mean_of(p_n, this->named("normal_pressure")));
  results.scalars.push_back(this->mean_of(p_t, this->named("tangential_pressure")));
  if (means[cost] > 1.0)
    results.notes.push_back(fmt::format(
        "{}: the test changes of area cost {:.2g} kT, of which the mean of exp(-U/kT) is hard to "
        "sample: take a smaller strain",
        this->settings().name, std::sqrt(means[cost])));
}

template <int D>
std::vector<std::string> SurfaceTension<D>::series_columns() const {
  return {"stress", "test_area"};
}

template <int D>
std::vector<double> SurfaceTension<D>::series_row() const {
  const std::vector<double>& newest = this->newest();
  if (newest.empty()) return {};
  return {newest[by_stress], newest[by_energy]};
}

template class SurfaceTension<2>;
template class SurfaceTension<3>;

}  // namespace odpd
