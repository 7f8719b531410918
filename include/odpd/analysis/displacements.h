#pragma once
// Mean-square displacement of many coordinates vectors by kind, and the diffusion coefficient of each kind,
//
//   D = (1/(2 d)) d/dt <|r(t) - r(0)|^2>          (Phan-Thien et al. 2016, eq. 52)
//
// as the least-squares slope between the lags `fit_from` and `window`; d is the number of components that count. One window
// begins where the last one ended, so that each gives an independent sample. Where the coordinates stood when the window
// began is kept here for few of them, or carried by the particles (Particles::carry). Of a kind that nothing belongs to both
// are undefined (NaN).
#include <span>
#include <string>
#include <vector>

#include "odpd/analysis/block_average.h"
#include "odpd/core/table.h"

namespace odpd {

class Displacements {
 public:
  /// window, fit_from, lag_time: longest lag, shortest lag of the slope, time between samples; `owner`: for messages.
  Displacements(std::string owner, double window, double fit_from, double lag_time,
                std::size_t kinds);

  /// A window has begun: there are places to measure from.
  bool begun() const { return begun_; }
  /// One sample: of each kind the sum of the squares of its displacements since the window began, and how many of the kind
  /// there are; `components` of the coordinates count. True when a window begins here: the next displacements are from
  /// where the coordinates stand now. The first sample of all begins one, and its sums do not count.
  bool add_sums(std::span<const double> sum, std::span<const double> population,
                std::size_t components);
  /// The same from the coordinates: `width` of them per entity, unwrapped, entities in the same order every time; kind[n] < 0:
  /// not counted. `components` of the coordinates count.
  void add(std::vector<double> now, std::span<const std::int32_t> kind, std::size_t width,
           std::span<const int> components);

  std::int64_t windows() const { return diffusion_.samples(); }
  std::int64_t lags() const { return lags_; }
  double lag(std::int64_t k) const { return lag_time_ * static_cast<double>(k + 1); }
  /// By lag * kinds + kind.
  const BlockAverage& curve() const { return curve_; }
  /// lag, and of each kind, by their names, the mean-square displacement and its standard error.
  Table table(std::span<const std::string> kinds) const;
  /// D of each kind, then of all entities; a sample per window.
  const BlockAverage& diffusion() const { return diffusion_; }
  /// The newest sample of `diffusion`.
  const std::vector<double>& newest() const { return newest_; }

  void save(StateWriter& out, const std::string& prefix) const;
  /// Throws IoError for a state of other sizes; `coordinates`: how many there are, those that particles carry left out.
  void load(const StateReader& in, const std::string& prefix, std::size_t coordinates);

 private:
  void finish_window(std::span<const double> population, std::size_t components);

  std::string owner_;
  double fit_from_, lag_time_;
  std::int64_t lags_;
  std::size_t kinds_;
  std::int64_t lag_ = 0;  // samples since the window began
  bool begun_ = false;
  std::vector<double> origin_;  // coordinates there, of `add`; empty before the first
  std::vector<double> window_;  // [lag * kinds + kind], filled as lags come
  BlockAverage curve_, diffusion_;
  std::vector<double> newest_;
};

}  // namespace odpd
