#pragma once
// Keys that several observers read. All throw ConfigError.
#include <string>
#include <vector>

#include "odpd/analysis/grid.h"
#include "odpd/analysis/observer.h"

namespace odpd {

/// A direction by its name: x, y or z.
template <int D>
int read_direction(const Config& config, const std::string& key, int fallback);

/// `axis`, by default where a profile makes sense: across a shear, along the first bounded direction, or along that in which the
/// force varies.
template <int D>
int read_axis(const ObserverEntry<D>& entry);

/// Something makes a flow along this direction: a force, a moving wall, shear, a body that is moved or pushed.
template <int D>
bool flows_along(const Scene<D>& scene, int direction);

/// `directions`, an array of names.
template <int D>
std::vector<int> read_directions(const Config& config, const std::vector<int>& fallback);

/// Lags of mean-square displacements: the longest, and the shortest of the slope (time).
struct LagRange {
  double window, fit_from;
};
/// `window` (3) and `fit_from` (a third of it).
LagRange read_lags(const Config& config);

/// `bins`, D counts; by default cells near 1 wide, at least `fewest` in every direction.
template <int D>
typename Grid<D>::Counts read_cells(const ObserverEntry<D>& entry, double fewest = 1.0);

/// `r_max` of distances between particles: at most half the shortest periodic edge, by default two cutoffs, or if `far` the most.
template <int D>
double read_r_max(const ObserverEntry<D>& entry, bool far = false);

/// Solves that take the noise out.
struct ControlKeys {
  std::int64_t every = 0;   ///< steps between controlled ones; 0: none
  double tolerance = 0.01;  ///< relative, of these solves
};

/// `control`, `control_every`, `control_tolerance`; a window must hold four controlled steps. Without a window (0) each sample has
/// control, and there is no `control_every`.
ControlKeys read_control(const Config& config, double window = 0.0, double dt = 0.0);
/// A note for results: what control may miss where a scene has bonds.
std::string control_with_bonds(const std::string& observer);

/// Refuses runs that cannot ask what the configuration of a step's start answers to a load (analysis/frozen.h).
template <int D>
void refuse_frozen(const ObserverEntry<D>& entry);
/// `incompressible`: with a pressure (analysis/frozen_pressure.h). Refuses it where no particle is free, so that nothing has a density.
template <int D>
bool read_incompressible(const ObserverEntry<D>& entry);
/// `tolerance` of such solves, relative.
double read_frozen_tolerance(const Config& config);

/// Refuses a `window` that is given and does not hold two steps.
void require_two_steps(const Config& config, double window, double dt);

}  // namespace odpd
