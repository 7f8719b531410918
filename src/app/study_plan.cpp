#include "odpd/app/study_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "odpd/app/case.h"
#include "odpd/app/info.h"
#include "odpd/app/simulation.h"
#include "odpd/core/error.h"
#include "odpd/pairs/registry.h"

namespace odpd {

namespace {

// What has no part in the equilibrium distribution: how the motion is followed and damped.
bool is_dynamical(const std::string& key) {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list{"integrator", "solver",     "run",         "output",
                                  "neighbours", "fluid.mass", "fluid.zeta_0"};
    for (const std::string& name : dynamical_model_keys()) list.push_back("fluid." + name);
    return list;
  }();
  return std::any_of(names.begin(), names.end(), [&](const std::string& name) {
    return key == name || key.starts_with(name + ".");
  });
}

// Files that a study does not need, and checks that belong to the case as it is.
std::vector<std::string> quiet_overrides() {
  return {"check=[]", "output.pictures=false", "output.trajectory_every=0", "output.vtk_every=0"};
}

ConfigValues budget_keys(const StudySettings& study) {
  ConfigValues keys;
  const StudyBudget& budget = study.budget;
  if (budget.duration > 0.0) keys.emplace_back("run.duration", fmt::format("{}", budget.duration));
  if (budget.equilibrate >= 0.0)
    keys.emplace_back("run.equilibrate", fmt::format("{}", budget.equilibrate));
  if (budget.standard_error > 0.0)
    keys.emplace_back("run.until",
                      fmt::format("{{ observable = \"{}\", standard_error = {} }}",
                                  study.observables.front().name, budget.standard_error));
  return keys;
}

// The last value of each key, in the order in which keys first came.
std::vector<std::string> overrides(const ConfigValues& keys) {
  std::vector<std::string> list;
  for (auto key = keys.begin(); key != keys.end(); ++key) {
    const bool first =
        std::none_of(keys.begin(), key, [&](const auto& k) { return k.first == key->first; });
    if (!first) continue;
    const auto last = std::find_if(keys.rbegin(), keys.rend(),
                                   [&](const auto& k) { return k.first == key->first; });
    list.push_back(key->first + "=" + last->second);
  }
  return list;
}

// Readable, and another one for another case or program: results of a study that was changed and changed back are still
// there.
std::string directory_name(const std::string& label, const std::string& resolved) {
  std::string name;
  for (const char c : label)
    if (c != ' ')
      name += is_plain_name(std::string(1, c)) || std::string(".=+,").find(c) != std::string::npos
                  ? c
                  : '-';
  std::uint32_t hash = 2166136261u;  // FNV-1a
  for (const char c : resolved + build_identity())
    hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
  return fmt::format("{}-{:08x}", name.substr(0, 200), hash);
}

std::string label_of(const StudySettings& study, const std::vector<std::size_t>& at) {
  std::string label;
  for (std::size_t k = 0; k < study.axes.size(); ++k) {
    const std::string& value = study.axes[k].values[at[k]].label;
    if (!label.empty()) label += ", ";
    label += k == study.method ? value : study.axes[k].name + "=" + value;
  }
  return label;
}

// What no run gives should not come out at the end of a long study.
template <int D>
void check_observables(const StudySettings& study, bool monte_carlo,
                       const Simulation<D>& simulation) {
  const Results measured = simulation.results();
  for (const StudyObservable& o : study.observables) {
    if (!o.table.empty() || (monte_carlo && o.kind != ReferenceKind::monte_carlo)) continue;
    if (const std::string why = measured.objection(o.name); !why.empty())
      throw ConfigError(why + "; name one of these, or add an [[observe]] to the case");
  }
}

template <int D>
void build_in(const StudySettings& study, bool monte_carlo, bool measure, const Config& config,
              const CaseSettings& settings, StudyRun& run) {
  Simulation<D> simulation(config, settings);
  check_observables(study, monte_carlo, simulation);
  if (!measure) return;
  constexpr int trials = 3;
  const Stopwatch watch;
  try {
    for (int k = 0; k < trials; ++k) simulation.step();
  } catch (const SolverError&) {  // a point that breaks at once costs next to nothing
  }
  run.step_seconds = watch.seconds() / trials;
}

// Builds the case: every key is read, and the defaults are known.
void build(const StudySettings& study, const StudyPoint& point, bool measure, StudyRun& run) {
  std::vector<std::string> all = run.overrides;
  const std::vector<std::string> quiet = quiet_overrides();
  all.insert(all.end(), quiet.begin(), quiet.end());
  try {
    const Config config = open_case(study.case_path, all);
    const CaseSettings settings = read_case(config, case_name(study.case_path));
    settings.dimension == 2 ? build_in<2>(study, point.monte_carlo, measure, config, settings, run)
                            : build_in<3>(study, point.monte_carlo, measure, config, settings, run);
    run.resolved = portable_case(config);
    run.dt = settings.clock.dt;
    run.steps = settings.clock.total_steps;
  } catch (const ConfigError& e) {
    throw ConfigError(
        fmt::format("{}: the point {}: {}", study.file.string(), point.label, e.what()));
  }
}

void add_runs(const StudySettings& study, const ConfigValues& keys, bool measure,
              StudyPoint& point) {
  const std::int64_t seeds = point.monte_carlo ? 1 : study.seeds;
  for (std::int64_t seed = 1; seed <= seeds; ++seed) {
    StudyRun run;
    ConfigValues all = keys;
    all.emplace_back("seed", std::to_string(seed));
    run.overrides = overrides(all);
    build(study, point, measure && seed == 1, run);
    run.name = directory_name(fmt::format("{},seed={}", point.label, seed), run.resolved);
    run.step_seconds = seed == 1 ? run.step_seconds : point.runs.front().step_seconds;
    point.runs.push_back(std::move(run));
  }
}

bool is_skipped(const StudySettings& study, const std::vector<std::size_t>& at) {
  return std::any_of(study.skip.begin(), study.skip.end(), [&](const auto& entry) {
    return std::all_of(entry.begin(), entry.end(), [&](const AxisMatch& match) {
      return std::find(match.values.begin(), match.values.end(), at[match.axis]) !=
             match.values.end();
    });
  });
}

// All combinations, the last axis running fastest.
std::vector<std::vector<std::size_t>> combinations(const StudySettings& study) {
  std::vector<std::vector<std::size_t>> list{{}};
  for (const StudyAxis& axis : study.axes) {
    std::vector<std::vector<std::size_t>> longer;
    for (const auto& at : list)
      for (std::size_t k = 0; k < axis.values.size(); ++k) {
        longer.push_back(at);
        longer.back().push_back(k);
      }
    list = std::move(longer);
  }
  std::erase_if(list, [&](const auto& at) { return is_skipped(study, at); });
  return list;
}

// With fluid.alpha, a follows from gamma and mass, and with fluid.rho alone the density from mass: an axis over those is
// another equilibrium at each value.
void refuse_hidden_equilibria(const StudySettings& study, const StudyPlan& plan) {
  const StudyRun& run = plan.points.front().runs.front();
  const Config fluid = Config::from_text(run.resolved, "case.toml").table("fluid");
  const bool by_alpha = fluid.has("alpha");
  const bool by_rho = fluid.has("rho") && !fluid.has("density") && !fluid.has("count");
  for (const StudyAxis& axis : study.axes)
    for (const AxisValue& value : axis.values)
      for (const auto& [key, text] : value.set)
        if ((by_alpha && key.starts_with("fluid.") && is_dynamical(key)) ||
            (by_rho && key == "fluid.mass"))
          throw ConfigError(fmt::format(
              "{}: the axis '{}' sets {}, from which fluid.{} makes another equilibrium: give {}, "
              "or another reference than \"monte-carlo\"",
              study.file.string(), axis.name, key, by_alpha ? "alpha" : "rho",
              by_alpha ? "fluid.a instead of fluid.alpha" : "fluid.density instead of fluid.rho"));
}

// The keys of the Monte Carlo run of a point's equilibrium, and a label that tells it from others.
std::pair<ConfigValues, std::string> equilibrium(const StudySettings& study,
                                                 const std::vector<std::size_t>& at) {
  ConfigValues keys;
  std::string label = "monte-carlo";
  for (const auto& key : study.set)
    if (!key.first.starts_with("integrator.") && !key.first.starts_with("run."))
      keys.push_back(key);
  for (std::size_t k = 0; k < study.axes.size(); ++k) {
    const AxisValue& value = study.axes[k].values[at[k]];
    ConfigValues physical = value.set;
    std::erase_if(physical, [](const auto& key) { return is_dynamical(key.first); });
    keys.insert(keys.end(), physical.begin(), physical.end());
    if (!physical.empty()) label += fmt::format(", {}={}", study.axes[k].name, value.label);
  }
  keys.insert(keys.end(), {{"integrator.name", "\"monte-carlo\""}, {"integrator.dt", "1.0"}});
  keys.insert(keys.end(), {{"run.equilibrate", "1000.0"}, {"run.duration", "20000.0"}});
  keys.insert(keys.end(), study.monte_carlo.begin(), study.monte_carlo.end());
  return {keys, label};
}

std::size_t reference_of(const StudySettings& study, const StudyPlan& plan, std::size_t point,
                         const StudyObservable& observable, std::size_t monte_carlo) {
  if (observable.kind == ReferenceKind::number) return plan.points.size();
  if (observable.kind == ReferenceKind::monte_carlo) return monte_carlo;
  std::vector<std::size_t> at = plan.points[point].at;
  for (const AxisMatch& match : observable.at) at[match.axis] = match.values.front();
  for (std::size_t k = 0; k < plan.points.size(); ++k)
    if (!plan.points[k].monte_carlo && plan.points[k].at == at) return k;
  throw ConfigError(fmt::format(
      "{}: the point {} is compared with {}, which [[skip]] leaves out; keep that one, or "
      "name another reference",
      study.file.string(), plan.points[point].label, label_of(study, at)));
}

}  // namespace

StudyPlan plan_study(const StudySettings& study, bool measure) {
  StudyPlan plan;
  const bool sampled =
      std::any_of(study.observables.begin(), study.observables.end(),
                  [](const auto& o) { return o.kind == ReferenceKind::monte_carlo; });
  std::map<std::string, std::size_t> samplers;  // by label
  std::vector<std::size_t> monte_carlo;         // of each point
  const auto all = combinations(study);
  if (all.empty())
    throw ConfigError(study.file.string() + ": [[skip]] leaves out every point; remove some of it");
  for (const auto& at : all) {
    if (!sampled) break;
    auto [keys, label] = equilibrium(study, at);
    if (!samplers.contains(label)) {
      samplers[label] = plan.points.size();
      plan.points.push_back({at, label, true, {}});
      add_runs(study, keys, measure, plan.points.back());
    }
    monte_carlo.push_back(samplers[label]);
  }
  if (sampled) refuse_hidden_equilibria(study, plan);
  const std::size_t references = plan.points.size();
  for (const auto& at : all) {
    ConfigValues keys = study.set;
    for (std::size_t k = 0; k < study.axes.size(); ++k) {
      const ConfigValues& more = study.axes[k].values[at[k]].set;
      keys.insert(keys.end(), more.begin(), more.end());
    }
    const ConfigValues budget = budget_keys(study);
    keys.insert(keys.end(), budget.begin(), budget.end());
    plan.points.push_back({at, label_of(study, at), false, {}});
    add_runs(study, keys, measure, plan.points.back());
  }
  plan.reference.resize(plan.points.size());
  for (std::size_t k = references; k < plan.points.size(); ++k)
    for (const StudyObservable& observable : study.observables)
      plan.reference[k].push_back(
          reference_of(study, plan, k, observable, sampled ? monte_carlo[k - references] : 0));
  return plan;
}

}  // namespace odpd
