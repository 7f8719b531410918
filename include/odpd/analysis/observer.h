#pragma once
// Observers only read the state. Each samples every so many steps of the measured part of a run and gives numbers with
// standard errors by block averaging, tables and charts. Which kinds there are stands in one table (analysis/registry.h).
//
// The smallest one names the numbers of a sample and measures them; averages, series and checkpoint follow:
//
//   class MeanSpeed : public Observer<2> {
//    public:
//     explicit MeanSpeed(ObserverSettings s) : Observer<2>(std::move(s), {"mean", "largest"}) {}
//     double moment() const override { return 0.5; }  // v_mid is the velocity of the middle of the step
//     void measure(const Clock&, const Particles<2>&, const StepRecord<2>& record) override { ... add({mean, largest}); }
//   };
#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "odpd/analysis/block_average.h"
#include "odpd/analysis/results.h"
#include "odpd/core/archive.h"
#include "odpd/core/config.h"
#include "odpd/dynamics/clock.h"
#include "odpd/dynamics/step_record.h"
#include "odpd/scene/scene.h"

namespace odpd {

/// What every observer has.
struct ObserverSettings {
  std::string kind;
  std::string name;        ///< prefix of its scalars and stem of its files
  std::int64_t every = 1;  ///< steps between samples
  bool series = false;     ///< write a time series
  /// Measured steps that may be sampled: after `from` of them, up to `until`.
  std::int64_t from = 0, until = std::numeric_limits<std::int64_t>::max();
};

/// What an observer is made from: its [[observe]] table and the run that it will look at.
template <int D>
struct ObserverEntry {
  std::string kind;
  const Config& config;
  const Scene<D>& scene;  ///< outlives the observer
  const Clock& clock;
  /// Steps are steps in time; otherwise (Monte Carlo) there are no velocities.
  bool in_time = true;
  /// As IntegratorTraits::two_stages.
  bool two_stages = true;
  /// As IntegratorTraits::half_way_velocity.
  bool half_way_velocity = false;

  /// Reads the keys of every observer: name, every, series, from, until. Throws ConfigError.
  ObserverSettings settings(std::int64_t default_every = 1) const;
};

template <int D>
class Observer {
 public:
  Observer(const Observer&) = delete;
  Observer& operator=(const Observer&) = delete;
  virtual ~Observer() = default;
  /// What it asks StepRecord::respond for: solves per step of the measured part, in the mean.
  virtual double solves() const { return 0.0; }
  const ObserverSettings& settings() const { return settings_; }

  bool is_due(const Clock& clock) const {
    const std::int64_t step = clock.measured_steps();
    return clock.measuring() && step % settings_.every == 0 && step > settings_.from &&
           step <= settings_.until;
  }
  /// Steps so far that were to be sampled.
  std::int64_t samples_due(const Clock& clock) const {
    const std::int64_t last = std::min(clock.measured_steps(), settings_.until);
    return std::max<std::int64_t>(0, last / settings_.every - settings_.from / settings_.every);
  }
  /// Where in a step its samples stand, and with them the rows of its series: 0 where it looks at the record's first stage
  /// (edges, forces and positions at the step's start), 1/2 at v_mid or at what acts during the step (means over the
  /// stages), 1 at the particles as the step leaves them.
  virtual double moment() const { return 0.0; }

  /// One sample from the step just done (clock.step already advanced past it): hands its numbers to `add`. All ranks of the
  /// particles call it together: it sums over its own particles (`owned`) and edges (`counts`), then over the ranks, so that
  /// all of them hold the same averages.
  virtual void measure(const Clock& clock, const Particles<D>& particles,
                       const StepRecord<D>& record) = 0;

  /// Adds all it has. The names of its scalars are the same at any time, their values NaN where there is nothing to tell
  /// (yet): what a case asks for is compared with them before it runs. Tables and charts come with the first sample. Unless
  /// overridden: the mean of each column, as <name>.<column>.
  virtual void add_results(Results& results) const;

  /// Columns after `time`, which is that of `moment`, and the row of the newest sample (empty: nothing new to write). Unless
  /// overridden: the sample.
  virtual std::vector<std::string> series_columns() const { return columns_; }
  virtual std::vector<double> series_row() const { return newest_; }

  /// What a restart needs. Unless overridden: the averages.
  virtual void save(StateWriter& out) const;
  virtual void load(const StateReader& in);

 protected:
  /// A sample has one number for each of `columns`.
  Observer(ObserverSettings settings, std::vector<std::string> columns);
  /// A sample has `width` numbers, named by whoever overrides add_results and series_columns. 0: it keeps other sums.
  explicit Observer(ObserverSettings settings, std::size_t width = 0);

  /// The one way into the averages.
  void add(std::vector<double> sample);
  const BlockAverage& average() const { return average_; }
  const std::vector<double>& newest() const { return newest_; }
  /// <name>.<what>
  std::string named(const std::string& what) const { return settings_.name + "." + what; }
  /// Mean and standard error of a column.
  Scalar mean_of(std::size_t column, std::string scalar_name) const;

 private:
  ObserverSettings settings_;
  std::vector<std::string> columns_;
  BlockAverage average_;
  std::vector<double> newest_;
};

}  // namespace odpd
