#include "odpd/app/restart.h"

#include <fmt/format.h>

#include <map>
#include <sstream>

#include "odpd/core/error.h"

namespace odpd {

namespace {

// Another value of these is another way to run, write or judge the same.
bool may_change(const std::string& path) {
  const auto in = [&](std::string_view table) { return path.starts_with(table); };
  if (path == "title" || path == "run.duration" || path == "run.blow_up" || path == "check")
    return true;
  // Holding the centre of mass is another problem, not another solver.
  if (in("solver.")) return path != "solver.hold_centre_of_mass";
  return in("run.until.") || in("output.") || in("check.");
}

struct Change {
  std::string before = "absent", now = "absent";
  bool one_sided() const { return before == "absent" || now == "absent"; }
};

// By path. The name of a file may differ, as its contents are those of the checkpoint.
std::map<std::string, Change> changes(const Config& saved, const Config& current) {
  std::map<std::string, Change> all;
  for (const auto& [path, value] : saved.flattened()) all[path].before = value;
  for (const auto& [path, value] : current.flattened()) all[path].now = value;
  for (const auto& file : current.files())
    if (const auto found = all.find(file.first); found != all.end() && !found->second.one_sided())
      all.erase(found);
  std::erase_if(all, [](const auto& entry) {
    return entry.second.before == entry.second.now || may_change(entry.first);
  });
  return all;
}

Config saved_case(CheckpointReader& in) {
  return Config::from_text(in.component("run").read_text("case"), "checkpoint");
}

[[noreturn]] void refuse(const std::string& path, const Change& change) {
  throw ConfigError(fmt::format(
      "the checkpoint belongs to another case: '{}' was {} and is {}. A restart may change title, "
      "run.duration, run.until, run.blow_up, [solver] (but not hold_centre_of_mass), [output], "
      "[[check]], the number of threads, and names of files such as start.file (their contents are "
      "in the checkpoint), nothing else",
      path, change.before, change.now));
}

bool is_text(const std::string& value) { return value.starts_with('"') || value.starts_with('\''); }

template <int D>
std::vector<double> flat(const std::vector<Vec<D>>& vectors) {
  std::vector<double> numbers;
  for (const Vec<D>& v : vectors) numbers.insert(numbers.end(), v.x.begin(), v.x.end());
  return numbers;
}

template <int D>
std::vector<Vec<D>> vectors_of(const std::vector<double>& numbers) {
  std::vector<Vec<D>> vectors(numbers.size() / D);
  for (std::size_t k = 0; k < D * vectors.size(); ++k) vectors[k / D].x[k % D] = numbers[k];
  return vectors;
}

}  // namespace

template <int D>
void save_inputs(const Config& config, const SceneSettings<D>& scene, CheckpointWriter& out) {
  StateWriter& inputs = out.component("inputs");
  std::string keys;
  for (const auto& [key, text] : config.file_texts()) {
    keys += key + "\n";
    inputs.write_text("files/" + key, text);
  }
  inputs.write_text("keys", keys);
  if (scene.start != StartKind::file) return;
  inputs.write("start/positions", flat(scene.start_positions));
  inputs.write("start/species",
               std::vector<std::int64_t>(scene.start_species.begin(), scene.start_species.end()));
  std::vector<std::int64_t> sizes;
  std::vector<Vec<D>> positions;
  for (const std::vector<Vec<D>>& body : scene.start_bodies) {
    sizes.push_back(static_cast<std::int64_t>(body.size()));
    positions.insert(positions.end(), body.begin(), body.end());
  }
  inputs.write("start/body_sizes", sizes);
  inputs.write("start/body_positions", flat(positions));
  if (scene.box.shear) inputs.write("start/shear", std::vector<double>{scene.box.shear->start});
}

void take_file_texts(CheckpointReader& in, const Config& config) {
  for (const auto& [path, change] : changes(saved_case(in), config))
    if (!change.one_sided() && (!is_text(change.before) || path == "start.from"))
      refuse(path, change);
  const StateReader& inputs = in.component("inputs");
  std::istringstream keys(inputs.read_text("keys"));
  ConfigValues texts;
  for (std::string key; std::getline(keys, key);)
    texts.emplace_back(key, inputs.read_text("files/" + key));
  config.use_file_texts(texts);
}

template <int D>
void take_start(CheckpointReader& in, SceneSettings<D>& scene) {
  if (scene.start != StartKind::file) return;
  const StateReader& inputs = in.component("inputs");
  scene.start_positions = vectors_of<D>(inputs.read_doubles("start/positions"));
  for (const std::int64_t species : inputs.read_integers("start/species"))
    scene.start_species.push_back(static_cast<std::int32_t>(species));
  const std::vector<Vec<D>> positions = vectors_of<D>(inputs.read_doubles("start/body_positions"));
  auto next = positions.begin();
  for (const std::int64_t size : inputs.read_integers("start/body_sizes")) {
    scene.start_bodies.emplace_back(next, next + size);
    next += size;
  }
  if (!scene.box.shear) return;
  scene.box.shear->start = inputs.read_doubles("start/shear").at(0);
  scene.box = scene.box.at(0.0);
}

void require_same_case(CheckpointReader& in, const Config& config) {
  const auto all = changes(saved_case(in), config);
  // Observers come last: their defaults follow from the rest.
  for (const bool of_observers : {false, true})
    for (const auto& [path, change] : all)
      if (path.starts_with("observe.") == of_observers) refuse(path, change);
}

template void save_inputs<2>(const Config&, const SceneSettings<2>&, CheckpointWriter&);
template void save_inputs<3>(const Config&, const SceneSettings<3>&, CheckpointWriter&);
template void take_start<2>(CheckpointReader&, SceneSettings<2>&);
template void take_start<3>(CheckpointReader&, SceneSettings<3>&);

}  // namespace odpd
