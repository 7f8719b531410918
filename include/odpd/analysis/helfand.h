#pragma once
// Viscosity at equilibrium from the growth of the integrated stress (Helfand 1960), with the random force in it as an impulse:
//
//   G(t) = V int S_ab dt,     eta = d/dt <(G(t + s) - G(s))^2> / (2 V kT)
//
// S dt is summed over all steps, as a step's stress is the mean of its stages and its noise acts throughout the step. At
// mass 0 the noise alone gives the viscosity of particles that follow the mean flow; what answers it in the same step, and
// later, corrects that. (The integral of the correlation of S without the noise has the wrong sign for the friction.)
// Components: S_ab of all pairs a < b, symmetrised, and (S_aa - S_bb)/2, which isotropy makes equivalent. Friction across the lines of
// centres resists vorticity too: S is not symmetric then, what answers the pure strain of these components is less than the viscosity
// of a flow (0.6 of it for a classical SDPD fluid in 2D), and they are all S_ab with a != b instead: the force along b that acts
// across a, in a flow along b with its gradient along a.
//
// Without mass what the noise makes of G is known. In a flow of rate 1 with the gradient E of a component,
// particles that follow it slip by A = E r at an edge of vector r, and give way by velocities w:
//
//   R w = J^T Z A,     G' = -(A - J w) . (f_C + f_B),     V eta_0 = <(A - J w) . Z (A - J w)>
//
// with J and Z of pairs/network.h, f_C and f_B the conservative and the random force of each edge. The part of f_B has the
// variance 2 kT V eta_0 of frozen configurations, and is uncorrelated with how it moves particles, J^T f_B, since J^T Z (A -
// J w) = 0. Where energies are of densities, f_C of edges is still minus their gradient, and the same holds. So
//
//   eta = eta_0 + lim <(int b dt)^2>/(2 V kT t),     b dt = dG + dt (A - J w) . f_B
//
// which is what linear response gives as well, as b/kT is what the flow E changes the probability of a configuration by per time.
#include <vector>

#include "odpd/dynamics/step_record.h"
#include "odpd/scene/scene.h"

namespace odpd {

/// What a step adds to G, by component.
template <int D>
std::vector<double> helfand_growth(const Scene<D>& scene, const Particles<D>& particles,
                                   const StepRecord<D>& record);

/// By component: what the noise makes of that, and V eta_0 of the step's start.
struct HelfandControl {
  std::vector<double> made, response;
};
/// One solve for each component, to this tolerance; V eta_0 is too large by the square of its error.
template <int D>
HelfandControl helfand_control(const Particles<D>& particles, const StepRecord<D>& record,
                               double tolerance);

/// The same of a flow along `flow` with its gradient along `gradient`, one component. Under shear S dt V less `made` has the same mean as
/// S dt V, whatever the flow: the noise of a step is drawn after its start.
template <int D>
HelfandControl shear_control(const Particles<D>& particles, const StepRecord<D>& record, int flow,
                             int gradient, double tolerance);

}  // namespace odpd
