// What a simulation leaves in a checkpoint and finds there.
#include <fmt/format.h>

#include <algorithm>

#include "odpd/app/restart.h"
#include "odpd/app/simulation.h"
#include "odpd/core/error.h"
#include "odpd/core/isa.h"
#include "odpd/core/log.h"

namespace odpd {

template <int D>
void Simulation<D>::save(CheckpointWriter& out) const {
  StateWriter& run = out.component("run");
  run.write_text("case", config_.resolved());
  save_inputs(config_, scene_.settings(), out);
  run.write("counts", std::vector<std::int64_t>{clock_.step, alarm_crossings_});
  const PhaseSeconds& phases = dynamics_.phases();
  run.write("phase_seconds", std::vector<double>(phases.seconds.begin(), phases.seconds.end()));
  run.write("wall_seconds", std::vector<double>{wall_seconds()});
  dynamics_.statistics().save(run);
  run.write_text("instructions", std::string(isa_name(isa())));
  dynamics_.solver().save(out.component("solver"));
  scene_.particles().save(out.component("particles"));
  integrator_->save(out.component("integrator"));
  watch_of_state_.save(out.component("blow_up"));
  for (std::size_t k = 0; k < observers_.size(); ++k)
    observers_[k]->save(out.component(fmt::format("observer_{}", k)));
}

template <int D>
void Simulation<D>::load(CheckpointReader& in) {
  const StateReader& run = in.component("run");
  require_same_case(in, config_);
  const std::vector<std::int64_t> counts = run.read_integers("counts");
  clock_.step = counts.at(0);
  if (clock_.step > clock_.total_steps)
    throw ConfigError(fmt::format(
        "the checkpoint is at t = {:.6g}, after the end of this run at t = {:.6g}: raise "
        "run.duration",
        clock_.time(), static_cast<double>(clock_.total_steps) * clock_.dt));
  alarm_crossings_ = counts.at(1);
  const std::vector<double> seconds = run.read_doubles("phase_seconds");
  std::copy(seconds.begin(), seconds.end(), dynamics_.phases().seconds.begin());
  earlier_seconds_ = run.read_doubles("wall_seconds").at(0);
  dynamics_.statistics().load(run);
  const std::int64_t expected = scene_.particles().size();
  scene_.particles().load(in.component("particles"));
  if (scene_.particles().size() != expected)
    throw ConfigError(fmt::format(
        "the checkpoint holds {} particles, the case has {}: it belongs to another case",
        scene_.particles().size(), expected));
  dynamics_.particles_replaced();
  if (const std::string path = run.read_text("instructions"); path != isa_name(isa()))
    log_warning(fmt::format(
        "the run so far took the instruction path {}, this process takes {}: rounding will differ "
        "(ODPD_ISA={} forces the former where the processor has it)",
        path, isa_name(isa()), path));
  dynamics_.solver().load(in.component("solver"), dynamics_.resistance());
  integrator_->load(in.component("integrator"));
  watch_of_state_.load(in.component("blow_up"));
  for (std::size_t k = 0; k < observers_.size(); ++k)
    observers_[k]->load(in.component(fmt::format("observer_{}", k)));
  stop_at_target();  // continued with a target that it had reached
}

#define ODPD_INSTANTIATE(D)                                   \
  template void Simulation<D>::save(CheckpointWriter&) const; \
  template void Simulation<D>::load(CheckpointReader&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
