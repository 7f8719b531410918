#include "odpd/app/run_output.h"

#include <fmt/format.h>

#include <exception>

#include "odpd/core/error.h"
#include "odpd/core/log.h"
#include "odpd/io/file.h"
#include "odpd/io/gnuplot.h"
#include "odpd/version.h"

namespace odpd {

namespace fs = std::filesystem;

RunLock prepare_run_directory(const fs::path& directory) try {
  if (fs::exists(directory) && !fs::is_directory(directory))
    throw IoError(fmt::format(
        "{}: a file is where the output directory should be; remove it or choose another --out",
        directory.string()));
  if (fs::exists(directory) && !fs::is_empty(directory)) {
    if (!RunLock::marks(directory))
      throw IoError(
          fmt::format("{}: the directory is not empty and holds no run of odpd, so it is left "
                      "alone; choose another --out",
                      directory.string()));
    const RunLock idle(directory);  // held until it is out of the way: nobody writes there
    const fs::path moved = move_aside(directory);
    log_info(fmt::format("the earlier run was moved to {}", moved.string()));
  }
  make_directory(directory);
  return RunLock(directory);
} catch (const fs::filesystem_error& e) {
  throw IoError(fmt::format("{}: cannot be used for the output: {}; choose another --out",
                            directory.string(), e.code().message()));
}

template <int D>
RunOutput<D>::RunOutput(fs::path directory, const Config& config, Simulation<D>& simulation)
    : directory_(std::move(directory)),
      config_(config),
      simulation_(simulation),
      trajectory_(directory_, portable_case(config), ODPD_VERSION, simulation.settings().title),
      vtk_(directory_) {}

template <int D>
fs::path RunOutput<D>::series_path(std::size_t k) const {
  return directory_ / (simulation_.observers()[k]->settings().name + "_series.csv");
}

template <int D>
void RunOutput<D>::begin() {
  write_file_atomically(directory_ / "case.toml", portable_case(config_));
  for (std::size_t k = 0; k < simulation_.observers().size(); ++k) {
    const auto& observer = *simulation_.observers()[k];
    series_.push_back(nullptr);
    if (!observer.settings().series) continue;
    std::vector<std::string> columns = observer.series_columns();
    columns.insert(columns.begin(), "time");
    series_.back() = std::make_unique<SeriesFile>(series_path(k), columns);
  }
  checkpoint();  // there is a state to go back to from the first step on
  first_frame();
}

template <int D>
void RunOutput<D>::first_frame() {
  if (simulation_.settings().output.trajectory_every > 0 && simulation_.clock().step == 0 &&
      trajectory_.frames() == 0)
    trajectory_.append(simulation_.frame());
}

template <int D>
void RunOutput<D>::check(CheckpointReader& in) {
  const StateReader& state = in.component("output");
  const std::vector<std::int64_t> bytes = state.read_integers("series_bytes");
  if (bytes.size() != simulation_.observers().size())
    throw IoError(
        fmt::format("{}: its checkpoint is of {} observers, the case has {}: it is damaged",
                    directory_.string(), bytes.size(), simulation_.observers().size()));
  for (std::size_t k = 0; k < bytes.size(); ++k)
    if (simulation_.observers()[k]->settings().series) SeriesFile::check(series_path(k), bytes[k]);
  trajectory_.reopen(state.read_integers("segment").at(0), state.read_integers("frames").at(0));
}

template <int D>
void RunOutput<D>::resume(CheckpointReader& in) {
  check(in);
  write_file_atomically(directory_ / "case.toml", portable_case(config_));
  // Until this part has ended, its summary is not that of the run.
  const fs::path summary = directory_ / "summary.json";
  if (fs::exists(summary)) fs::rename(summary, directory_ / "summary.previous.json");
  const StateReader& state = in.component("output");
  const std::vector<std::int64_t> bytes = state.read_integers("series_bytes");
  for (std::size_t k = 0; k < simulation_.observers().size(); ++k)
    series_.push_back(simulation_.observers()[k]->settings().series
                          ? std::make_unique<SeriesFile>(series_path(k), bytes.at(k))
                          : nullptr);
  trajectory_.delete_later();
  vtk_.resume_at(state.read_doubles("vtk_times"), state.read_integers("vtk_steps"));
  first_frame();
}

template <int D>
void RunOutput<D>::after_step() {
  const PhaseTimer timer(simulation_.dynamics().phases(), Phase::write);
  const Clock& clock = simulation_.clock();
  const OutputSettings& output = simulation_.settings().output;
  const auto due = [&](std::int64_t every) { return every > 0 && clock.step % every == 0; };
  for (std::size_t k = 0; k < series_.size(); ++k) {
    const auto& observer = *simulation_.observers()[k];
    if (!series_[k] || !observer.is_due(clock)) continue;
    std::vector<double> row = observer.series_row();
    if (row.empty()) continue;
    // The step just done began at step - 1. What Monte Carlo's observers see is the configuration that a sweep began with.
    const double moment = simulation_.in_time() ? observer.moment() : 0.0;
    row.insert(row.begin(), (static_cast<double>(clock.step - 1) + moment) * clock.dt);
    series_[k]->append(row);
  }
  if (due(output.trajectory_every)) trajectory_.append(simulation_.frame());
  if (due(output.vtk_every)) vtk_.append(simulation_.frame());
  if (due(output.checkpoint_every)) checkpoint(true);
}

template <int D>
void RunOutput<D>::checkpoint(bool ends_segment) {
  simulation_.judge();
  std::vector<std::int64_t> bytes;
  for (auto& series : series_) {
    if (series) series->flush(true);
    bytes.push_back(series ? series->bytes() : 0);
  }
  ends_segment ? trajectory_.close_segment() : trajectory_.save_segment();
  CheckpointWriter out;
  simulation_.save(out);
  StateWriter& state = out.component("output");
  state.write("series_bytes", bytes);
  state.write("segment", std::vector<std::int64_t>{trajectory_.segment()});
  state.write("frames", std::vector<std::int64_t>{trajectory_.frames()});
  state.write("vtk_times", vtk_.times());
  state.write("vtk_steps", vtk_.steps());
  out.save(directory_ / "checkpoint.h5");
}

template <int D>
void RunOutput<D>::salvage() noexcept {
  try {
    for (auto& series : series_)
      if (series) series->flush();
    trajectory_.save_segment();
  } catch (const std::exception& e) {
    log_warning(fmt::format("and the output so far could not all be written: {}", e.what()));
  }
}

template <int D>
void RunOutput<D>::leave_last_good() noexcept {
  try {
    checkpoint();
  } catch (const std::exception&) {
    // This state is not sound: the checkpoint stays that of one that was.
  }
  try {
    if (!simulation_.last_good().id.empty())
      trajectory_.write_single("last_good.h5", simulation_.last_good());
  } catch (const std::exception& e) {
    log_warning(fmt::format("and the last sound configuration could not be written: {}", e.what()));
  }
}

template <int D>
void RunOutput<D>::close() {
  const PhaseTimer timer(simulation_.dynamics().phases(), Phase::write);
  vtk_.append_last(simulation_.frame());
  checkpoint();
}

template <int D>
void RunOutput<D>::write_results(const Results& results) {
  const PhaseTimer timer(simulation_.dynamics().phases(), Phase::write);
  for (const auto& [name, table] : results.tables) write_csv(directory_ / (name + ".csv"), table);
  if (!simulation_.settings().output.pictures) return;
  bool drawn = true;
  for (const auto& [name, chart] : results.charts)
    drawn = drawn && draw_chart(directory_ / name, chart);
  if (drawn) draw_particles(directory_ / "particles", simulation_.frame(), 0);
}

template <int D>
void RunOutput<D>::write_summary(const std::string& text) {
  write_file_atomically(directory_ / "summary.json", text);
  std::error_code ignored;
  fs::remove(directory_ / "summary.previous.json", ignored);
}

template class RunOutput<2>;
template class RunOutput<3>;

}  // namespace odpd
