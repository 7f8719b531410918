#include "odpd/analysis/helfand.h"

#include "odpd/analysis/frozen.h"
#include "odpd/analysis/stress.h"
#include "odpd/core/index.h"

namespace odpd {

namespace {

// The flow of rate 1 that belongs to a component. Without friction across e: shear of the plane a, b, or with `second` stretching
// along a and compression along b. With it: flow along a with its gradient along b, or the other way round.
template <int D>
Gradient<D> strain(int a, int b, bool second, bool transverse) {
  if (transverse) return second ? shear_gradient<D>(b, a) : shear_gradient<D>(a, b);
  Gradient<D> E{};
  E[index(a)][second ? a : b] = 0.5;
  E[index(b)][second ? b : a] = second ? -0.5 : 0.5;
  return E;
}

template <int D>
void add_flow(const Particles<D>& particles, const StepRecord<D>& record, const Gradient<D>& E,
              double tolerance, HelfandControl& control) {
  const FlowAnswer answer = answer_to_flow(particles, record, E, tolerance);
  control.made.push_back(-record.dt * answer.noise);
  control.response.push_back(answer.power);
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
        add_flow(particles, record, strain<D>(a, b, second, transverse), tolerance, control);
  return control;
}

template <int D>
HelfandControl shear_control(const Particles<D>& particles, const StepRecord<D>& record, int flow,
                             int gradient, double tolerance) {
  HelfandControl control;
  add_flow(particles, record, shear_gradient<D>(flow, gradient), tolerance, control);
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
