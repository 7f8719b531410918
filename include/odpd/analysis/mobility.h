#pragma once
// Short-time mobilities of free bodies and of molecules at sampled configurations: velocity of a centre per force on it, and
// angular velocity per torque, while nothing has moved (analysis/frozen.h), in a fluid that does not give way to compression
// (analysis/frozen_pressure.h): that of Stokes flow around the bodies where they are. kT mobility is short-time diffusion without the noise
// of a run (Einstein). By [[body]] and [[molecule]]:
//
//   translation    (1/d) sum_c e_c . mu e_c,    rotation  (1/n) sum_c e_c . mu_r e_c,  n axes that it turns about
//   collective     (1/d N) sum_c V_c per force on each, where all N are pushed alike
//
// of mu = S (P^T R P)^+ S^T. S^T F is F/p on each of its p particles; S^T T is (I^+ T) x a_k on the one at arm a_k, which on a
// rigid body is that force or torque, and whose answer S v is the mean velocity and the rigid spin closest to v. On a molecule of one particle
// that spins T is the torque on it. With unit
// loads one solve has one direction of one body. With random ones f = S^T z, z = +-1 of every component of all N bodies, E z z^T = 1,
// so that z . mu z is N times the mean over all of them but for its spread (Hutchinson 1990), with a solve for translation and one
// for rotation: worth it where they feel little of each other, as rotations do.
//
// Where nothing takes up a force (no wall, no held body, no drag) the opposite one is spread over the box, and velocities are relative
// to the mean over it: that of a periodic box without net flow. Free particles share in it alike, the sites of a body as the fluid in
// its place would where the `excluded_volume` of every [[body]] is given, n v_ex of them by n fluid particles per volume between bodies,
// else like other particles; so the beads of a [[molecule]] with an `excluded_volume`. With the volume it is the uniform pressure gradient of Hasimoto 1959. Beads of a molecule give way to the
// load each by itself, as springs take time: it is the mobility before they do, above that of a rigid body of the same beads.
#include "odpd/analysis/frozen_pressure.h"
#include "odpd/analysis/molecule_beads.h"
#include "odpd/analysis/observer.h"
#include "odpd/core/random.h"
#include "odpd/core/rotation.h"

namespace odpd {

struct MobilitySettings {
  std::vector<std::size_t> bodies, molecules;  ///< of these [[body]] and [[molecule]], all free
  std::int64_t sample = 4;    ///< of each kind and configuration, at random; unit loads only
  bool random_loads = false;  ///< on all at once
  bool own_axes = false;      ///< directions are those of the body's shape, turned with it
  bool collective = false;
  bool incompressible = true;  ///< with a pressure; false: friction alone
  double tolerance = 0.01;     ///< of the solves, relative
};

template <int D>
class Mobility : public Observer<D> {
 public:
  Mobility(ObserverSettings settings, MobilitySettings mobility, const Scene<D>& scene);
  static std::unique_ptr<Observer<D>> make(const ObserverEntry<D>& entry);
  double solves() const override;
  void measure(const Clock& clock, const Particles<D>& particles,
               const StepRecord<D>& record) override;

 private:
  /// What is loaded: the particles of one body or molecule, in memory, and their arms.
  struct Mover {
    std::vector<std::int32_t> particles;
    std::vector<Vec<D>> arms;
    Rotation<D> axes;         // of the directions of unit loads
    std::uint64_t which = 0;  // of its random numbers
    bool spins = false;       // it is one particle that spins

    /// Axes that it turns about.
    int rotations() const;
    /// Adds a torque t. False where it is about the line of a rod, and nothing.
    bool load_by_torque(const Vec<D>& t, ParticleLoads<D>& loads) const;
  };
  /// Means over movers; NaN: they do not turn, or not about that axis.
  struct Answers {
    double translation = 0.0, rotation = 0.0;
    std::vector<double> components;  // with unit loads: of translation, then of rotation
  };
  struct Step {
    const Particles<D>& particles;
    const StepRecord<D>& record;
    const FrozenPressure<D>* pressure;
  };
  std::vector<std::vector<Mover>> movers(const Step& step) const;
  std::vector<Mover> chosen(std::vector<Mover> movers, std::uint64_t step) const;
  /// Of a force on each body and molecule, with 1 for a particle of the fluid.
  struct Weights {
    std::vector<double> site,
        bead;  // of each [[body]] and [[molecule]]; both empty: all particles share alike
  };
  static Weights weights_of_kinds(const Scene<D>& scene);
  /// How much of the opposite force each particle takes, with 1 for those of the fluid.
  std::vector<double> weights(const Particles<D>& particles) const;
  /// f . R^-1 f of loads on the particles.
  double answer(const Step& step, ParticleLoads<D> loads) const;
  Answers to_unit_loads(const Step& step, const std::vector<Mover>& movers) const;
  Answers to_random_loads(const Step& step, const std::vector<Mover>& movers) const;
  double to_one_force_on_all(const Step& step, const std::vector<Mover>& movers) const;

  MobilitySettings mobility_;
  const Scene<D>& scene_;
  Weights kind_weight_;
  MoleculeBeads<D> beads_;
  CounterRandom random_;
};

}  // namespace odpd
