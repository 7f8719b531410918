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
#include "odpd/analysis/block_average.h"
#include "odpd/analysis/observer.h"

namespace odpd {

template <int D>
class Thermo : public Observer<D> {
 public:
  Thermo(ObserverSettings settings, const Scene<D>& scene);
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;
  void add_results(Results& results) const override;
  std::vector<std::string> series_columns() const override;
  std::vector<double> series_row() const override { return newest_; }
  void save(StateWriter& out) const override { average_.save(out, "average"); }
  void load(const StateReader& in) override { average_.load(in, "average"); }

 private:
  const Scene<D>& scene_;
  BlockAverage average_;  // energy, pressure, |F|^2, laplacian, kinetic temperature
  std::vector<double> newest_;
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
