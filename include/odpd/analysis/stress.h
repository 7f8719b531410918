#pragma once
// Stress tensor from the edges (Irving and Kirkwood 1950), tension positive. With the stages (r, v1) and (r*, v2) of a step, their
// weights b and 1 - b (StepRecord::start_weight: 1/2 for trapezoidal, 0 for midpoint), and the random force F_B formed at r,
//
//   S = -K/V - (1/V) sum_edges [ b r (x) (F_C + F_D(v1)) + (1 - b) r* (x) (F_C* + F_D*(v2)) + r (x) F_B ]
//
// r: from j to i, F: force on i. F_B acts in both stages and always with the arm of the step's start: with the arms of the stages it
// would carry (1 - b) c 2 n kT more, c dt being the reach of the first stage, n kT for both schemes. K = N kT I at mass 0; with mass
// sum m v v of the velocities at the step's start, less those of the flow of [shear]; under other flows it holds
// their own momentum flux.
//
// Forces on constituents of a rigid body of unknown motion act at its centre, which is one particle in K (molecular stress): the
// forces that hold it together then need not be known.
//
// V: the volume between the wall surfaces; of an edge that leaves it, the part of its line inside counts, and of the particles those
// inside (analysis/fluid_region.h). In the same way with bins along an axis. Scalars <name>.xx, .xy, ... (all D^2),
// <name>.pressure = -trace/D and its parts .pressure.kinetic, .conservative, .friction, .noise. At equilibrium friction and noise add nothing, as dt -> 0, and the pressure is
// that of `thermo`. Schemes with one stage (euler, extrapolated, implicit) at mass 0 take friction before the motion alone: biased,
// and a note says so.
#include "odpd/analysis/observer.h"

namespace odpd {

/// Where stress is wanted: the whole region between the wall surfaces, and bins of it along an axis (none: 0).
struct StressBins {
  int axis = 1;
  std::int64_t bins = 0;
};

enum StressPart : std::size_t { kinetic_part, conservative_part, friction_part, noise_part };
constexpr std::size_t stress_parts = 4;

/// Stress of one step: the four parts over the whole region, D^2 numbers (row-major) each, then the sum of the parts per bin.
/// The same bits on any thread count. edge_noise and corrector of the record may be absent.
template <int D>
std::vector<double> stress_of(const Scene<D>& scene, const Particles<D>& particles,
                              const StepRecord<D>& record, const StressBins& bins);

template <int D>
class Stress : public Observer<D> {
 public:
  Stress(ObserverSettings settings, StressBins bins, const Scene<D>& scene);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  double moment() const override { return 0.5; }
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  std::vector<std::string> series_columns() const override;
  std::vector<double> series_row() const override;
  void save(StateWriter& out) const override;
  void load(const StateReader& in) override;

 private:
  static constexpr std::size_t components = D * D;
  // Columns of a sample: the parts, their sum, the pressures (total and by part), the bins.
  static constexpr std::size_t total_column = stress_parts * components;
  static constexpr std::size_t pressure_column = total_column + components;
  static constexpr std::size_t bin_column = pressure_column + 1 + stress_parts;
  void add_profile(Results& results) const;

  StressBins bins_;
  const Scene<D>& scene_;
  bool one_stage_ = false;  // some sample came from a massless step without a second stage
};

}  // namespace odpd
