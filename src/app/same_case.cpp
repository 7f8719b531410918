#include "odpd/app/same_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

#include "odpd/app/scene_frame.h"
#include "odpd/core/error.h"
#include "odpd/pairs/registry.h"

namespace odpd {

namespace {

// The case names a file there whose contents are in the checkpoint.
bool is_file_of_model(const std::string& path) {
  const auto named = [&](const std::string& key) { return path.ends_with("." + key); };
  const std::vector<std::string> keys = model_file_keys();
  return (path.starts_with("fluid.") || path.starts_with("pair.")) &&
         std::any_of(keys.begin(), keys.end(), named);
}

// The values that a restart must find unchanged.
std::vector<std::pair<std::string, std::string>> fixed_values(const Config& config) {
  std::vector<std::pair<std::string, std::string>> values;
  for (const auto& value : config.flattened()) {
    const std::string& path = value.first;
    const auto in = [&](std::string_view table) { return path.rfind(table, 0) == 0; };
    if (path == "title" || path == "run.duration" || path == "run.blow_up" ||
        path == "start.file" || path == "bonds.file" || is_file_of_model(path) ||
        path == "check")
      continue;
    if (in("run.until.")) continue;
    // Holding the centre of mass is another problem, not another solver.
    if (in("solver.") && path != "solver.hold_centre_of_mass") continue;
    if (in("output.") || in("check.")) continue;
    values.push_back(value);
  }
  std::sort(values.begin(), values.end());
  return values;
}

// The first value in which two cases differ, in words; empty when there is none.
std::string difference(const Config& saved, const Config& current) {
  const auto before = fixed_values(saved);
  const auto now = fixed_values(current);
  std::map<std::string, std::pair<std::string, std::string>> both;
  for (const auto& [path, value] : before) both[path].first = value;
  for (const auto& [path, value] : now) both[path].second = value;
  // Observers come last: their defaults follow from the rest.
  for (const bool of_observers : {false, true})
    for (const auto& [path, values] : both)
      if (values.first != values.second && path.starts_with("observe.") == of_observers)
        return fmt::format("'{}' was {} and is {}", path,
                           values.first.empty() ? "absent" : values.first,
                           values.second.empty() ? "absent" : values.second);
  return {};
}

// Their law's numbers, which a file may give.
std::vector<double> bond_numbers(const std::vector<Bond>& bonds) {
  std::vector<double> numbers;
  for (const Bond& bond : bonds)
    numbers.insert(numbers.end(), {bond.p.H, bond.p.r_0, bond.p.r_max});
  return numbers;
}

}  // namespace

template <int D>
void save_case(const Config& config, const Scene<D>& scene, StateWriter& run) {
  run.write_text("case", config.resolved());
  if (const auto& shear = scene.box().shear)
    run.write("shear_start", std::vector<double>{shear->start});
  if (!scene.bonds().empty()) {
    run.write("bonds", bond_ends(scene.bonds()));
    run.write("bond_numbers", bond_numbers(scene.bonds()));
  }
  scene.settings().model->save(run);
}

template <int D>
void require_same_case(const StateReader& run, const Config& config, const Scene<D>& scene) {
  const Config saved = Config::from_text(run.read_text("case"), "checkpoint");
  if (const std::string what = difference(saved, config); !what.empty())
    throw ConfigError(fmt::format(
        "the checkpoint belongs to another case: {}. A restart may change run.duration, "
        "run.until, run.blow_up, [solver] (but not hold_centre_of_mass), [output], [[check]] and "
        "the number of threads, "
        "nothing else",
        what));
  if (!scene.bonds().empty() && (run.read_integers("bonds") != bond_ends(scene.bonds()) ||
                                 run.read_doubles("bond_numbers") != bond_numbers(scene.bonds())))
    throw ConfigError(
        "the checkpoint has other bonds than the file of [bonds] now: restore that file");
  if (const auto& shear = scene.box().shear;
      shear && run.read_doubles("shear_start").at(0) != shear->start)
    throw ConfigError(
        fmt::format("the images of the checkpoint's run began with an offset of {}, those of "
                    "start.file with {}: start.file must be the one of that run",
                    run.read_doubles("shear_start").at(0), shear->start));
  scene.settings().model->check(run);
}

#define ODPD_INSTANTIATE(D)                                                 \
  template void save_case<D>(const Config&, const Scene<D>&, StateWriter&); \
  template void require_same_case<D>(const StateReader&, const Config&, const Scene<D>&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
