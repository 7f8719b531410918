#pragma once
// What the configuration of a step's start answers to a load while nothing in it moves on. No time passes: neither noise nor
// drift is in it, and one solve gives what a run at this configuration would have to average.
//
//   A force f on each particle:                 R w = f,          f . R^-1 f = 2 f.w - w.R w + e.R e
//   A flow of rate 1, slips A = E r at edges:   R w = J^T Z A,    V eta = (A - J w) . Z (A - J w) - e.R e
//
// with R = P^T (sum J^T Z J + zeta_0) P, J and Z of pairs/network.h (w and f with the angular velocities of particles that spin, and torques on
// them), and e the error of w: of second order, so that a loose
// tolerance does. f . R^-1 f is how fast f . r moves for that force, and kT of it is how fast it spreads by diffusion (Einstein).
// V eta is what particles that give way to each other still dissipate of the flow, over its rate squared: eta is the stress of
// the configuration over the rate, that of a flow so fast to and fro that it changes nothing.
//
// Friction knows no pressure. The answer is that of a viscous medium that can be compressed, at once: where friction is along the lines of
// centres, resistance to compression along a direction is 3 eta, as in an elastic body of Poisson's ratio 1/4 (Cauchy). Forces that keep
// the density need a time of some eta/K, K the bulk modulus, to make Stokes flow of it. For rigid inclusions elasticity then says:
//   spheres: drag 5.14 pi eta a in place of 6 pi eta a; eta (1 + 2.05 phi) in place of 1 + 2.5 phi; torque 8 pi eta a^3 as it is
//   disks:   eta (1 + 1.5 phi) in place of 1 + 2 phi; mobility some 4/3 times as large
// A FrozenPressure (analysis/frozen_pressure.h) makes Stokes flow of it without that time; then both quadratic forms are those that no
// compression leaves.
#include <array>
#include <vector>

#include "odpd/analysis/frozen_pressure.h"
#include "odpd/dynamics/step_record.h"
#include "odpd/particles/particles.h"

namespace odpd {

template <int D>
struct ForceAnswer : ParticleMotions<D> {  ///< w
  double mobility = 0.0;  ///< f . R^-1 f; where nothing takes up a net force, of f less its mean
  double noise = 0.0;     ///< w . J^T F_B: what the random force of the step adds to f . r per time
};

/// One solve to this tolerance (0: that of the run), and with a pressure those that find it. Throws SolverError.
template <int D>
ForceAnswer<D> answer_to_force(const Particles<D>& particles, const StepRecord<D>& record,
                               const ParticleLoads<D>& loads, double zeta_0, double tolerance,
                               const FrozenPressure<D>* pressure = nullptr);

/// E: component c of the slip is E[c] . r.
template <int D>
using Gradient = std::array<Vec<D>, index(D)>;

/// Flow along `flow` with its gradient along `gradient`, of rate 1.
template <int D>
Gradient<D> shear_gradient(int flow, int gradient) {
  Gradient<D> E{};
  E[index(flow)][gradient] = 1.0;
  return E;
}

struct FlowAnswer {
  double power = 0.0;  ///< V eta (mass length^(2 - d)/time, times V)
  double noise =
      0.0;  ///< (A - J w) . F_B: the part of the step's random stress that moves nothing, -V times it
};

/// Likewise. Bodies are carried with their centres (analysis/force_points.h). There is no drag, and no known velocity.
template <int D>
FlowAnswer answer_to_flow(const Particles<D>& particles, const StepRecord<D>& record,
                          const Gradient<D>& E, double tolerance,
                          const FrozenPressure<D>* pressure = nullptr);

}  // namespace odpd
