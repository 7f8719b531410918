#pragma once
// When a run has blown up, why, and what to do. With b = run.blow_up, kT the largest of the scene, and u the slip between
// neighbours that the drive can cause (u^2 = (2 U)^2 r_c/H for walls of speed U a gap H apart, or bodies of given speed in a box
// H long; u = k U r_c of a wave at the start), and F_b the forces on bodies (a torque as one at its edge, or at r_c), a state is judged bad when
//
//   energy per particle      U/N > b (U_0 + d kT + |f| H + sum F_b r_c/N), N the particles that move, those of bodies included; U_0 the
//                            larger of that at the start and of a random arrangement of the same density, of hard cores one that
//                            leaves out pairs with u > 10 kT (pairs/pair_moments.h); f the body force
//   kinetic temperature      of pairs within the cutoff, m <|v_i - v_j|^2>/(2 d) > b (kT + U_0 + m u^2)(1 + 10/n), with n degrees
//                            of freedom: a flow common to both does not count, nor does a small system's scatter
//   configurational          sum |F_i|^2 > b (kT (L + 3 S) + N_f F_u^2 + sum F_b^2) over the N_f free particles, L = sum lap_i U,
//   temperature              S^2 = sum (lap_i U)^2, F_u the drag that the drive can cause on a particle; at equilibrium
//                            <sum |F|^2> = kT <L>, and where particles lie at random L vanishes (soft repulsion:
//                            their energy is hardly raised then).
//                            kT > 0 and f_c != 0 only. An unrelaxed start does not pass, or by chance, so this counts from the
//                            first state on that is settled, sum |F_i|^2 <= 3 (kT L + N_f F_u^2 + sum F_b^2); after 50 times
//                            the limit of explicit steps, in which soft particles find their places, from the first that passes
//   jumps                    more than half of the pairs within the cutoff moved by more than it relative to each other in
//                            the last step; only where the largest |f_c| r_c >= 10 kT, as weak repulsion does not mind
//
// No sound run comes near any of them; a smaller b makes the first three more severe.
#include <cstdint>
#include <optional>
#include <string>

#include "odpd/core/archive.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/scene/scene.h"

namespace odpd {

/// Whether Scene::explicit_step_limit concerns this integrator.
bool repulsion_is_explicit(const IntegratorSettings& integrator);
/// Whether it takes bonds explicitly, so that a smaller step may cure one that has become too long.
bool bonds_are_explicit(const IntegratorSettings& integrator);

template <int D>
class BlowUpWatch {
 public:
  static constexpr std::int64_t interval = 100;  ///< steps between judgements
  static constexpr double relaxations =
      50.0;  ///< limits of explicit steps that an unrelaxed start is given to settle

  /// `scene` must outlive it. multiple: b above.
  BlowUpWatch(const Scene<D>& scene, double multiple);

  /// What is wrong with the state at this stage (edges and potential forces at the particles' positions), whose particles
  /// moved by dt times their velocity in the step before; empty when it passes.
  std::string judge(const Stage<D>& stage, double dt);

  /// Likely causes and remedies. particle: identity of the one that fails, -1 for none.
  std::string cure(const IntegratorSettings& integrator, const Stage<D>& stage, double dt,
                   std::int64_t particle) const;
  /// A dt to go on with: below every limit of this integrator, and at most half of dt; two digits.
  double smaller_step(const IntegratorSettings& integrator, const Stage<D>& stage, double dt) const;

  /// Identity of the free particle with the largest velocity; -1 where nothing moves.
  std::int64_t fastest() const;

  void save(StateWriter& out) const;
  void load(const StateReader& in);

 private:
  struct Pairs;  // sums over the pairs of free particles within the cutoff
  Pairs sum_pairs(const Stage<D>& stage, double dt) const;
  std::string judge_temperatures(const Stage<D>& stage, const Pairs& pairs,
                                 const std::vector<double>& force_squared,
                                 const std::vector<double>& laplacian);
  std::optional<double> repulsion_limit() const;
  double spin_relaxation(const Stage<D>& stage) const;
  double friction_limit(const IntegratorSettings& integrator, const Stage<D>& stage) const;
  double fluid_depth() const;

  const Scene<D>& scene_;
  double multiple_;
  double flow_slip_ = 0.0;                  // u
  double load_ = 0.0, load_squared_ = 0.0;  // sums of F_b and F_b^2
  double start_energy_ = -1.0;              // per particle; negative before the first judgement
  bool ordered_ = false;                    // some state had a sound configurational temperature
};

}  // namespace odpd
