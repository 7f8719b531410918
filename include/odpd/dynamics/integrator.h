#pragma once
// Integrators advance the particles by one step and report what they did. Made by name.
//
//   trapezoidal  stochastic trapezoidal rule, two solves per step, right drift (the default)
//   euler        one solve per step as in the overdamped paper, biased: kept to reproduce it
#include <memory>
#include <string>
#include <vector>

#include "odpd/core/archive.h"
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
  virtual int stages() const = 0;
  /// What a user must know before believing its results; empty when there is nothing.
  virtual std::string warning() const { return {}; }
  /// One step of clock.dt from clock.step. The record stays valid until the next step.
  virtual const StepRecord<D>& step(Dynamics<D>& dynamics, const Clock& clock) = 0;
  /// Arrays carried from step to step (none for schemes that only know r).
  virtual void save(StateWriter&) const {}
  virtual void load(const StateReader&) {}
};

std::vector<std::string> integrator_names();
/// Throws ConfigError for an unknown name, listing the names.
template <int D>
std::unique_ptr<Integrator<D>> make_integrator(const std::string& name);

}  // namespace odpd
