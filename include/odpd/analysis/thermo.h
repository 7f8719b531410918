#pragma once
// Equilibrium averages from the edges at the start of each sampled step:
//
//   energy per particle      (sum_edges u + wall potentials) / N, N the particles that move: free ones, and those of bodies of
//                            unknown motion. An edge to a particle of known motion counts in full: its energy is that of the one
//                            that moves. Edges between two of known motion there are none.
//   pressure                 (N_V kT + (1/d) sum_edges l r f_c) / V   (conservative virial; friction and noise add nothing at
//                            equilibrium, physics of m = 0). V: the volume between the wall surfaces; l: the part of the edge's line
//                            inside (analysis/fluid_region.h), 1 without walls; N_V: free particles and bodies of unknown motion
//                            there, each body one particle at its centre. As that of `stress`: its kinetic and conservative part.
//   configurational          <sum_i |F_i|^2> / <sum_i lap_i U> over free particles, F the conservative force (wall
//   temperature              potentials included); kT at equilibrium (Rugh 1997); not a thermometer under flow;
//                            undefined where f_c of some pair jumps at its end (PairMoments::force_jumps)
//   kinetic temperature      with mass only: m sum |v - V|^2 / (d (N_f - c)) over the N_f free particles, with v at the step's
//                            start, of variance kT/m; V the mean velocity and c = 1 where momentum is conserved, else 0; under flow
//                            the flow's own kinetic energy is in it
//   rotational               where free particles with a moment of inertia I spin: sum I |w - W|^2 over them and their components
//   temperature              (one in 2D, three in 3D), with w at the step's start, of variance kT/I; W that of a sheared box, half the
//                            curl of its flow, else 0. Momentum of spins alone is not conserved
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
  bool turns_;  // somebody has a rotational temperature
};

/// Kinetic temperature of these velocities, one per particle (0 without mass).
template <int D>
double kinetic_temperature(const Scene<D>& scene, const Particles<D>& particles,
                           const std::vector<Vec<D>>& velocity);

/// Conservative |F|^2 and Laplacian of U per particle at a stage, zero for particles of known velocity; the energy of this rank's
/// particles in the potentials of walls.
template <int D>
void configurational_terms(const Scene<D>& scene, const Particles<D>& particles,
                           const Stage<D>& stage, std::vector<double>& force_squared,
                           std::vector<double>& laplacian, double& wall_energy);

}  // namespace odpd
