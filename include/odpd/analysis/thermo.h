#pragma once
// Equilibrium averages from the edges at the start of each sampled step:
//
//   energy per particle      (sum_edges u + wall potentials) / N
//   pressure                 n kT + (1/(d V)) sum_edges r f_c   (conservative virial; friction and noise add nothing at
//                            equilibrium, physics of m = 0)
//   configurational          <sum_i |F_i|^2> / <sum_i lap_i U> over free particles, F the conservative force (wall
//   temperature              potentials included); kT at equilibrium (Rugh 1997); not a thermometer under flow
//   kinetic temperature      with mass only: m sum |v - V|^2 / (d (N - c)) with v at the step's start, of variance kT/m;
//                            V the mean velocity and c = 1 where momentum is conserved, else 0; under flow the flow's
//                            own kinetic energy is in it
//
// N: free particles; V: the volume between wall surfaces; edges to wall particles count half in the virial.
#include "odpd/analysis/observer.h"

namespace odpd {

template <int D>
class Thermo : public Observer<D> {
 public:
  /// in_time: with mass there are velocities, and with them a kinetic temperature.
  Thermo(ObserverSettings settings, const Scene<D>& scene, bool in_time = true);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;

 private:
  const Scene<D>& scene_;
  bool in_time_;
};

/// Kinetic temperature of these velocities, one per particle (0 without mass).
template <int D>
double kinetic_temperature(const Scene<D>& scene, const Particles<D>& particles,
                           const std::vector<Vec<D>>& velocity);

/// Conservative |F|^2 and Laplacian of U per particle at a stage, zero for particles of known velocity.
template <int D>
void configurational_terms(const Scene<D>& scene, const Particles<D>& particles,
                           const Stage<D>& stage, std::vector<double>& force_squared,
                           std::vector<double>& laplacian, double& wall_energy);

}  // namespace odpd
