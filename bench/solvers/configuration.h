#pragma once
// Configurations and right-hand sides for the solver benchmark: the standard fluid (a = 18.5, gamma = 4.5, s = 1/2, kT = 1,
// dt = 0.005) or one of SDPD between walls or periodic, with or without rigid bodies, in equilibrium or a periodic replica of a smaller box
// that is.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "odpd/dynamics/dynamics.h"
#include "odpd/scene/scene.h"
#include "suspension_bodies.h"

namespace bench {

inline constexpr double time_step = 0.005;
inline constexpr std::uint64_t seed = 1;
/// Larger fluids are replicas of a box of at most so many particles.
inline constexpr std::int64_t largest_base = 12500;

struct FluidSpec {
  bool walls = false;            ///< two frozen layers at either end of the last direction
  std::int64_t particles = 540;  ///< those that move: free ones and sites of bodies
  double density = 4.0;          ///< of the free ones (1/length^d)
  double s = 0.5;                ///< exponent of w_D
  double support = 0.0;          ///< of SDPD's kernel in spacings; 0: DPD
  bool classical = false;        ///< SDPD's form with friction across lines of centres
  double thin = 0.0;             ///< length of direction 0; 0: a square or cube
  bool gap = false;              ///< a third of the box is empty: half its length is added
  bool far_friction = false;     ///< gamma_far = 0.1 to 1.5 cutoffs
  std::int64_t obstacle = 0;     ///< particles in the middle that move with velocity 1 along x
  double shift = 0.0;            ///< on the diagonal (mass/time)
  std::optional<BodySpec> bodies = {};  ///< rigid ones that move freely
  double shear = 0.0;                   ///< rate; the start is sheared for 20 steps (1/time)
  bool held = false;                    ///< the centre of mass is held
  double gamma_perp = 0.0;              ///< friction across lines of centres
  double spinning = 0.0;                ///< part of the free particles, with lever radii of 1/2

  std::string geometry() const { return walls ? "walls" : "periodic"; }
};

template <int D>
struct Start {
  std::vector<odpd::Vec<D>> fluid;  ///< positions of the free particles (length)
  std::vector<odpd::RigidPose<D>> bodies;
  bool empty() const { return fluid.empty() && bodies.empty(); }
};

/// A start without gap or obstacle: random, relaxed, then `steps` trapezoidal steps under a drag of 1 (which leaves the
/// equilibrium alone and rattlers harmless); above `largest_base` particles copies of such a box, each particle and body
/// jittered by up to 0.03 per component. Throws ConfigError for a number of particles that no such copies make, and for
/// bodies that do not fit.
template <int D>
Start<D> equilibrated(const FluidSpec& spec, std::int64_t steps = 50);

/// One A x = b: edges, R and the load of conservative forces, wall motion and noise.
template <int D>
class Problem {
 public:
  Problem(const FluidSpec& spec, const Start<D>& start);

  /// A anew, so that whoever is bound next pays for what it derives from it; seconds.
  double rebuild();
  /// What is to be solved, made by `rebuild`.
  const odpd::System& system() const { return resistance.system(); }
  /// Every tenth edge, chosen at random, becomes a bond of stiffness k_c dt = ratio zeta.
  void stiffen(double ratio);
  /// Edges between free particles, counted at both ends, per free particle.
  double neighbours();

  FluidSpec spec;
  std::unique_ptr<odpd::Scene<D>> scene;
  std::unique_ptr<odpd::Surroundings<D>> surroundings;
  std::unique_ptr<odpd::Dynamics<D>> dynamics;
  odpd::Stage<D> stage;
  std::vector<double> load;  ///< for `system`, from the first `rebuild` on
  odpd::SpinResistance<D> resistance;
  double stiffness_time = 0.0;  ///< weight of k_c in A (time)

 private:
  bool load_scaled_ = false;
};

/// The scene at this start; reused by whoever steps it.
template <int D>
std::unique_ptr<odpd::Scene<D>> scene_at(const FluidSpec& spec, const Start<D>& start);

}  // namespace bench
