#include "odpd/analysis/helfand.h"

#include "odpd/analysis/force_points.h"
#include "odpd/analysis/stress.h"
#include "odpd/core/index.h"
#include "odpd/operator/edge_sums.h"

namespace odpd {

namespace {

// E r of the component a, b: shear, or stretching along a and compression along b.
template <int D>
Vec<D> strained(int a, int b, bool stretch, const Vec<D>& r) {
  Vec<D> slip{};
  slip[a] = 0.5 * r[stretch ? a : b];
  slip[b] = stretch ? -0.5 * r[b] : 0.5 * r[a];
  return slip;
}

}  // namespace

template <int D>
std::vector<double> helfand_growth(const Scene<D>& scene, const Particles<D>& particles,
                                   const StepRecord<D>& record) {
  const std::vector<double> stress = stress_of(scene, particles, record, StressBins{});
  const auto total = [&](std::size_t a, std::size_t b) {
    double sum = 0.0;
    for (std::size_t part = 0; part < stress_parts; ++part) sum += stress[(part * D + a) * D + b];
    return scene.fluid_volume() * record.dt * sum;
  };
  std::vector<double> growth;
  for (std::size_t a = 0; a < D; ++a)
    for (std::size_t b = a + 1; b < D; ++b) {
      growth.push_back(0.5 * (total(a, b) + total(b, a)));
      growth.push_back(0.5 * (total(a, a) - total(b, b)));
    }
  return growth;
}

template <int D>
HelfandControl helfand_control(const Particles<D>& particles, const StepRecord<D>& record,
                               double tolerance) {
  const PairNetwork<D>& network = record.start.network;
  const ForcePoints<D> points(particles, record.start);
  const std::size_t edges = index(network.size());
  HelfandControl control;
  for (int a = 0; a < D; ++a)
    for (int b = a + 1; b < D; ++b)
      for (const bool stretch : {false, true}) {
        const auto affine = [&](std::size_t k) {
          return strained(a, b, stretch, points.between(network, k));
        };
        std::vector<Vec<D>> friction(edges), load(record.start.position.size());
        for (std::size_t k = 0; k < edges; ++k)
          friction[k] = -1.0 * friction_of<D>(network, k, affine(k));
        add_edge_forces<D>(network, friction, load);
        const std::vector<Vec<D>> w = record.respond(load, tolerance);
        double along_noise = 0.0, power = 0.0;
        for (std::size_t k = 0; k < edges; ++k) {
          if (!network.counts(k)) continue;
          const Vec<D> slip = affine(k) - w[index(network.i[k])] + w[index(network.j[k])];
          power -= dot(slip, friction_of<D>(network, k, slip));
          along_noise += dot(record.edge_noise[k], slip);
        }
        control.made.push_back(-record.dt * along_noise);
        control.response.push_back(power);
      }
  particles.ranks().sum(control.made);
  particles.ranks().sum(control.response);
  return control;
}

#define ODPD_INSTANTIATE(D)                                                            \
  template std::vector<double> helfand_growth<D>(const Scene<D>&, const Particles<D>&, \
                                                 const StepRecord<D>&);                \
  template HelfandControl helfand_control<D>(const Particles<D>&, const StepRecord<D>&, double);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
