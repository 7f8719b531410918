#pragma once
// High-frequency viscosity: the stress that the configuration at a step's start answers to a flow of rate 1 while it has no time to
// change (answer_to_flow of analysis/frozen.h):
//
//   eta_ab = (1/V) (A - J w) . Z (A - J w),   A = r_b e_a at each edge,   R w = J^T Z A
//
// of a flow along a with its gradient along b, what sliding images of that shear would do to the pairs at once: at frequencies at which
// neither springs nor structure have time to answer. With the pressure of an incompressible fluid (analysis/frozen_pressure.h) it is, over that of the fluid
// alone, what suspended bodies add in Stokes flow; without it, one solve for each plane, it is `frozen` of analysis/helfand.h. In the fluid itself
// structure and time still raise it to the viscosity (docs/rheology.md).
#include "odpd/analysis/observer.h"

namespace odpd {

struct FlowPlane {
  int flow = 0, gradient = 1;
};

struct HighFrequencySettings {
  std::vector<FlowPlane> planes;
  bool incompressible = true;  ///< with a pressure; false: friction alone
  double tolerance = 0.01;     ///< of the solves, relative
};

template <int D>
class HighFrequencyViscosity : public Observer<D> {
 public:
  HighFrequencyViscosity(ObserverSettings settings, HighFrequencySettings flows,
                         const Scene<D>& scene);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  double solves() const override;
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;

 private:
  HighFrequencySettings flows_;
  const Scene<D>& scene_;
};

}  // namespace odpd
