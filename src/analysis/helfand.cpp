#include "odpd/analysis/helfand.h"

#include "odpd/analysis/force_points.h"
#include "odpd/analysis/stress.h"
#include "odpd/core/index.h"
#include "odpd/operator/edge_sums.h"

namespace odpd {

namespace {

// The slip at r in the flow of rate 1 that belongs to a component. Without friction across e: shear of the plane a, b, or with
// `second` stretching along a and compression along b. With it: flow along a with its gradient along b, or the other way round.
template <int D>
Vec<D> strained(int a, int b, bool second, bool transverse, const Vec<D>& r) {
  Vec<D> slip{};
  if (transverse) {
    slip[second ? b : a] = r[second ? a : b];
    return slip;
  }
  slip[a] = 0.5 * r[second ? a : b];
  slip[b] = second ? -0.5 * r[b] : 0.5 * r[a];
  return slip;
}

// What belongs to the flow that slips by flow(r) at an edge of vector r.
template <int D, class Flow>
void add_flow(const Particles<D>& particles, const StepRecord<D>& record, double tolerance,
              const Flow& flow, HelfandControl& control) {
  const PairNetwork<D>& network = record.start.network;
  const ForcePoints<D> points(particles, record.start);
  const std::size_t edges = index(network.size());
  const auto affine = [&](std::size_t k) { return flow(points.between(network, k)); };
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
  control.made.push_back(-record.dt * particles.ranks().sum(along_noise));
  control.response.push_back(particles.ranks().sum(power));
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
      if (record.start.network.transverse) {
        growth.push_back(total(b, a));
        growth.push_back(total(a, b));
        continue;
      }
      growth.push_back(0.5 * (total(a, b) + total(b, a)));
      growth.push_back(0.5 * (total(a, a) - total(b, b)));
    }
  return growth;
}

template <int D>
HelfandControl helfand_control(const Particles<D>& particles, const StepRecord<D>& record,
                               double tolerance) {
  const bool transverse = record.start.network.transverse;
  HelfandControl control;
  for (int a = 0; a < D; ++a)
    for (int b = a + 1; b < D; ++b)
      for (const bool second : {false, true})
        add_flow(
            particles, record, tolerance,
            [&](const Vec<D>& r) { return strained(a, b, second, transverse, r); }, control);
  return control;
}

template <int D>
HelfandControl shear_control(const Particles<D>& particles, const StepRecord<D>& record, int flow,
                             int gradient, double tolerance) {
  HelfandControl control;
  add_flow(
      particles, record, tolerance,
      [&](const Vec<D>& r) {
        Vec<D> slip{};
        slip[flow] = r[gradient];
        return slip;
      },
      control);
  return control;
}

#define ODPD_INSTANTIATE(D)                                                                      \
  template std::vector<double> helfand_growth<D>(const Scene<D>&, const Particles<D>&,           \
                                                 const StepRecord<D>&);                          \
  template HelfandControl helfand_control<D>(const Particles<D>&, const StepRecord<D>&, double); \
  template HelfandControl shear_control<D>(const Particles<D>&, const StepRecord<D>&, int, int,  \
                                           double);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
