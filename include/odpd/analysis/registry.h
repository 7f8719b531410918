#pragma once
// Which observers there are, and those of a case.
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "odpd/analysis/observer.h"
#include "odpd/dynamics/integrator.h"

namespace odpd {

/// A kind of observer, as [[observe]] names it.
template <int D>
struct ObserverKind {
  std::string name;
  /// Reads the kind's keys. Throws ConfigError.
  std::function<std::unique_ptr<Observer<D>>(const ObserverEntry<D>&)> make;
  /// Measures by velocities or time: left out, with a warning, of Monte Carlo.
  bool of_motion = false;
  bool always = false;  ///< every run has one, with its defaults where the case names none
};

/// The table of all kinds.
template <int D>
const std::vector<ObserverKind<D>>& observer_kinds();

/// The observers of a case: its [[observe]] entries, of the kinds of the table and of `own`, and those that are always
/// there. Under an `integrator` without time (Monte Carlo) those of motion are left out. `scene` must outlive them. Throws
/// ConfigError for unknown kinds, bad keys, names given twice.
template <int D>
std::vector<std::unique_ptr<Observer<D>>> make_observers(
    const Config& config, const Scene<D>& scene, const Clock& clock,
    const IntegratorTraits& integrator = integrator_traits("trapezoidal"),
    const std::vector<ObserverKind<D>>& own = {});

}  // namespace odpd
