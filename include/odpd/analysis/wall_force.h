#pragma once
// Force that the fluid exerts on each wall, from the edges between free and wall particles, as the mean of the stages:
//
//   F_wall = sum_{i in wall} sum_j (F_C + F_D + F_B)_ij  +  reaction to the smooth potential      (Phan-Thien et al. 2016, eq. 30)
//
// F_B is that of the step's start in both stages. Scalars: <name>.<side>.<direction>, force per wall area; and with two
// walls facing each other along y, <name>.shear_stress.x = (F_low - F_high)/(2 area) along x: half of what drags the lower
// wall forward and holds the upper one back.
#include "odpd/analysis/observer.h"

namespace odpd {

template <int D>
class WallForce : public Observer<D> {
 public:
  WallForce(ObserverSettings settings, const Scene<D>& scene);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  double moment() const override { return 0.5; }
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  std::vector<std::string> series_columns() const override;

 private:
  std::string side(std::size_t wall) const;
  double area(std::size_t wall) const;
  void add_stage(const Particles<D>& particles, const Stage<D>& stage,
                 const std::vector<Vec<D>>& noise_force, double weight,
                 std::vector<double>& sample) const;

  // A sample: force per area, wall by wall, D components each; then shear stresses.
  const Scene<D>& scene_;
};

}  // namespace odpd
