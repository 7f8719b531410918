#pragma once
// Integrators advance the particles by one step and report what they did. Made by name; each header states the scheme,
// how it obtains the drift kT div R^-1, its order without noise, and where it breaks.
//
//   trapezoidal      m >= 0, two solves: stochastic trapezoidal rule, right drift (the default)
//   midpoint         m >= 0, two solves: Fixman's half step and full step, right drift
//   extrapolated     m >= 0, one solve: right drift from the step before
//   implicit         m >= 0, one solve: the same with the stiffness of the repulsion taken implicitly
//   euler            m = 0, one solve: the overdamped paper's step, biased
//   setd             m > 0, no solve: stochastic exponential time differencing
//   velocity-verlet  m > 0, no solve: Groot and Warren's modified velocity-Verlet
//   shardlow         m > 0, no solve: exact pairwise splitting
//   monte-carlo      no motion: samples the equilibrium of the scene's energy, the exact reference for the others
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "odpd/core/archive.h"
#include "odpd/core/config.h"
#include "odpd/dynamics/clock.h"
#include "odpd/dynamics/dynamics.h"
#include "odpd/dynamics/step_record.h"

namespace odpd {

template <int D>
class Integrator {
 public:
  virtual ~Integrator() = default;
  virtual std::string name() const = 0;
  /// Solves per step.
  virtual int solves() const = 0;
  /// Throws ConfigError when the scheme has no answer for this scene, and has the particles carry what it keeps of them. To be
  /// called before the first step and before the particles of a checkpoint are loaded.
  virtual void prepare(Dynamics<D>&) {}
  /// What a user must know before believing its results; empty when there is nothing.
  virtual std::string warning() const { return {}; }
  /// What it did, for the report of a scheme that solves nothing.
  virtual std::string summary() const { return {}; }
  /// One step of clock.dt from clock.step. The record stays valid until the next step. A step that throws has moved
  /// nothing and carries what it carried before.
  virtual const StepRecord<D>& step(Dynamics<D>& dynamics, const Clock& clock) = 0;
  /// What it carries from step to step besides the columns of the particles (nothing for schemes that only know r and v).
  virtual void save(StateWriter&) const {}
  virtual void load(const StateReader&) {}

  /// Room for a stage between two steps, for whoever must look at the state. The next step overwrites it. (The edges of
  /// a million particles are most of a run's memory.)
  Stage<D>& spare_stage() { return record_.corrector; }

 protected:
  using Unknowns = typename Dynamics<D>::Unknowns;

  /// What every step begins with: memory in order, edges and forces at r, the velocity there.
  void begin(Dynamics<D>& dynamics, const Clock& clock);
  /// What steps with implicit friction end with: r' = r + dt P q_mid, and with mass p' = 2 p_mid - p, p = P^T P q the
  /// momentum per mass, p_mid that halfway.
  void finish(Dynamics<D>& dynamics, const Clock& clock, const Unknowns& q_mid,
              const Unknowns& p_mid);

  /// r' = r + dt P q_mid, and the record's v_mid and w_mid.
  void move(Dynamics<D>& dynamics, const Clock& clock, const Unknowns& q_mid);

  StepRecord<D> record_;
};

/// A vector of unknowns that a scheme keeps from step to step: what belongs to free particles in a column that they carry
/// (Particles::carry), so that it follows them in memory and into checkpoints, and their spins in another; w and V of bodies here.
template <int D>
class CarriedUnknowns {
 public:
  /// name: of the column, unique in a run.
  explicit CarriedUnknowns(std::string name) : name_(std::move(name)) {}
  /// Nothing was kept yet.
  bool empty() const { return empty_; }
  /// The particles carry the column from now on. Before anything is kept or loaded.
  void prepare(Dynamics<D>& dynamics);
  void keep(Dynamics<D>& dynamics, const std::vector<double>& q);
  /// In the present order of the unknowns. Throws IoError where a checkpoint held those of other bodies.
  std::vector<double> unknowns(Dynamics<D>& dynamics) const;
  /// All but the column. Throws IoError where something was kept and `prepare` was not called: the column was not loaded.
  void save(StateWriter& out) const;
  void load(const StateReader& in);

 private:
  std::string spin_name() const;

  std::string name_;
  bool empty_ = true, prepared_ = false;
  std::vector<double> bodies_;  // w of each, then V of each, D numbers
};

enum class Masses { any, zero, positive };

/// What holds for a scheme whatever it runs: columns of the table of integrators (src/dynamics/registry.cpp).
struct IntegratorTraits {
  Masses masses = Masses::any;  ///< that it takes
  /// Steps are steps in time. Otherwise (Monte Carlo sweeps) there are no velocities; only positions mean something.
  bool in_time = true;
  /// Two solves a step, with the same noise: the record has a corrector and `respond`.
  bool two_stages = false;
  /// v_mid is the velocity of half a step that the scheme goes on from, and v_start the mean of two of them.
  bool half_way_velocity = false;
  bool moves_bodies = true;     ///< rigid bodies of unknown motion
  bool turns_particles = true;  ///< that spin
  bool runs_sheared = true;     ///< under [shear]
  /// Explicit in the conservative force: its stiffness limits dt.
  bool repulsion_limits_dt = true;
  bool takes_implicit_bonds = false;  ///< may treat bonds alone implicitly (`implicit_bonds`)
  /// Explicit in the friction from this `order` on: m/friction limits dt. 0: never.
  int friction_limits_dt_from = 0;
};

/// [integrator] of a case file; keys that a scheme does not use are not read.
struct IntegratorSettings {
  std::string name = "trapezoidal";
  double lambda = 0.5;         ///< velocity-verlet: the velocity is predicted lambda dt ahead
  double theta = 0.5;          ///< implicit: weight of the end of the step
  int order = 1;               ///< setd: 1 or 2
  bool implicit_bonds = true;  ///< trapezoidal and midpoint: bonds implicitly (two_stage.h)
  double step = 0.0;  ///< monte-carlo: largest displacement per component at first; 0: 0.3 cutoffs
};

std::vector<std::string> integrator_names();
/// Throws ConfigError for an unknown name, listing the names.
const IntegratorTraits& integrator_traits(const std::string& name);
/// Reads the table [integrator] but its dt. Throws ConfigError.
IntegratorSettings read_integrator(const Config& config);
/// Why this integrator cannot run particles of this mass, with the remedy; empty when it can.
std::string mass_objection(const std::string& name, double mass);
/// Why this integrator cannot move rigid bodies of unknown motion; empty when it can.
std::string bodies_objection(const std::string& name);
/// Why this integrator cannot turn particles that spin, some of them (`massless`) without a moment of inertia, with the remedy; empty
/// when it can.
std::string spin_objection(const std::string& name, bool massless);
/// Why this integrator cannot run under [shear], with the remedy; empty when it can.
std::string shear_objection(const std::string& name);
/// Throws ConfigError for an unknown name, listing the names.
template <int D>
std::unique_ptr<Integrator<D>> make_integrator(const IntegratorSettings& settings);
template <int D>
std::unique_ptr<Integrator<D>> make_integrator(const std::string& name) {
  IntegratorSettings settings;
  settings.name = name;
  return make_integrator<D>(settings);
}

}  // namespace odpd
