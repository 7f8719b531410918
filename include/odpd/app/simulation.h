#pragma once
// A case put together: scene, dynamics, integrator, clock and observers, and the loop that drives them.
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "odpd/analysis/registry.h"
#include "odpd/app/blow_up.h"
#include "odpd/app/case.h"
#include "odpd/app/scene_frame.h"
#include "odpd/core/error.h"
#include "odpd/dynamics/integrator.h"
#include "odpd/io/checkpoint_file.h"
#include "odpd/scene/scene.h"

namespace odpd {

template <int D>
class Simulation {
 public:
  /// Builds everything the case names and rejects keys that nobody read; `own_observers`: kinds that [[observe]] may name besides
  /// those of odpd. With `restart`, whose file texts `config` has (`take_file_texts`), no file is read; `load` follows. Throws
  /// ConfigError, IoError. `ranks`, which must outlive it, share the particles; they make it and call its functions together.
  Simulation(const Config& config, CaseSettings settings,
             const std::vector<ObserverKind<D>>& own_observers = {},
             CheckpointReader* restart = nullptr,
             const Communicator& ranks = Communicator::alone());

  const CaseSettings& settings() const { return settings_; }
  const Clock& clock() const { return clock_; }
  Scene<D>& scene() { return scene_; }
  Dynamics<D>& dynamics() { return dynamics_; }
  const Dynamics<D>& dynamics() const { return dynamics_; }
  const Scene<D>& scene() const { return scene_; }
  const Integrator<D>& integrator() const { return *integrator_; }
  /// As IntegratorTraits::in_time.
  bool in_time() const { return integrator_traits(settings_.integrator.name).in_time; }
  const std::vector<std::unique_ptr<Observer<D>>>& observers() const { return observers_; }

  /// One step and the measurements that are due after it.
  const StepRecord<D>& step();
  /// Steps until the clock has run out, the target of [run] until is reached, or `stop()` says so on some rank; `after_step` writes
  /// what is due. Throws BlowUpError as `judge` does.
  void run(const std::function<bool()>& stop, const std::function<void()>& after_step);

  /// Judges the state of this moment and, when it passes, remembers it. Throws BlowUpError with cause and remedy.
  void judge();
  /// The last state that passed; empty when none has.
  const Frame& last_good() const { return last_good_; }
  /// A time step to go on with after a blow-up.
  double smaller_step() const {
    return watch_of_state_.smaller_step(settings_.integrator, judged(), clock_.dt);
  }
  bool stopped_at_target() const { return stopped_at_target_; }

  /// The particles now, in models with densities with these: then the state is judged, and BlowUpError thrown as `judge` does.
  Frame frame();
  /// All that was measured so far; names are complete from the start.
  Results results() const;
  /// Particles the mirror caught during the measured part: every check fails when there were any.
  std::int64_t alarm_crossings() const { return alarm_crossings_; }

  /// Seconds since this object was made, plus those of the parts of the run before a restart.
  double wall_seconds() const { return earlier_seconds_ + watch_.seconds(); }

  void save(CheckpointWriter& out) const;
  /// Continues from a checkpoint of the same case. Throws ConfigError naming the first value that differs.
  void load(CheckpointReader& in);

 private:
  const StepRecord<D>& named_step();
  [[noreturn]] void explain(const SolverError& error);
  void refuse_long_bond(const SolverError& error, const std::string& message) const;
  // Schemes and steps that no fluid of densities can take.
  void refuse_densities(const Config& config) const;
  void check_observables(const Config& config) const;
  void stop_at_target();
  /// The state that was judged last.
  Stage<D>& judged() const { return integrator_->spare_stage(); }

  Config config_;
  CaseSettings settings_;
  Clock clock_;
  Scene<D> scene_;
  Dynamics<D> dynamics_;
  std::unique_ptr<Integrator<D>> integrator_;
  std::vector<std::unique_ptr<Observer<D>>> observers_;
  std::int64_t alarm_crossings_ = 0;
  bool alarmed_ = false;  // the user was told once
  BlowUpWatch<D> watch_of_state_;
  std::int64_t judged_step_ = -1;
  Frame last_good_;
  bool stopped_at_target_ = false;
  double earlier_seconds_ = 0.0;
  Stopwatch watch_;
};

}  // namespace odpd
