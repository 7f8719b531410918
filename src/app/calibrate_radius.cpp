#include "odpd/app/calibrate_radius.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "odpd/analysis/frozen_pressure.h"
#include "odpd/app/interrupt.h"
#include "odpd/app/radius_record.h"
#include "odpd/app/report.h"
#include "odpd/app/run_output.h"
#include "odpd/app/simulation.h"
#include "odpd/core/error.h"
#include "odpd/core/log.h"
#include "odpd/core/timer.h"

namespace odpd {

namespace {

namespace fs = std::filesystem;

template <int D>
RadiusRecord read_body_record(const CalibrateRadiusOptions& options, const Config& config,
                              const CaseSettings& settings) {
  const Simulation<D> simulation(config, settings);
  RadiusRecord record;
  record.body = measured_body(config, simulation.scene(), settings.clock.dt, options.body);
  record.edges = options.edges.empty() ? record.body.default_edges() : options.edges;
  std::sort(record.edges.begin(), record.edges.end());
  record.edges.erase(std::unique(record.edges.begin(), record.edges.end()), record.edges.end());
  if (options.relative_error > 0.0) record.relative_error = options.relative_error;
  const double least =
      std::max(4.0 * record.body.reach, 2.0 * (record.body.reach + record.body.cutoff));
  for (const double edge : record.edges)
    if (!(edge > least))
      throw ConfigError(fmt::format(
          "--boxes: an edge of {:.6g} is too short: a body must be shorter than half of it, with a "
          "cutoff of fluid beyond its {:.6g}; longer than {:.6g} will do",
          edge, record.body.reach, least));
  const double cell = pressure_spacing * record.body.cutoff;
  for (const double edge : record.edges)
    if (std::abs(edge / cell - std::round(edge / cell)) > 0.01)
      log_warning(fmt::format(
          "--boxes: {:.6g} is no whole multiple of {:.6g}, the width of the cells of the pressure, "
          "which the viscosity goes by: {:.6g} is",
          edge, cell, cell * std::ceil(edge / cell)));
  return record;
}

// An earlier calibration of the same is gone on with, of something else moved aside.
RunLock prepare_radius_directory(const fs::path& directory, RadiusRecord& record) {
  const fs::path file = directory / "radius.json";
  if (!fs::exists(file) || !RunLock::marks(directory)) return prepare_run_directory(directory);
  bool same = false;
  {
    const RunLock lock(directory);
    same = continue_radius(file, record);
  }
  if (same) return RunLock(directory);
  log_info(fmt::format("{} is of another fluid or body", file.string()));
  return prepare_run_directory(directory);
}

double ball_volume(int dimension, double a) {
  return (dimension > 2 ? unit_ball_volume<3> : unit_ball_volume<2>)*std::pow(a, dimension);
}

// Below, a standard error is hardly known.
constexpr std::int64_t least_samples = 32;

class RadiusCalibrator {
 public:
  RadiusCalibrator(const CalibrateRadiusOptions& options, RadiusRecord& record, fs::path directory)
      : options_(options),
        record_(record),
        directory_(std::move(directory)),
        stopped_(options.limit_seconds) {}

  /// False where it ended early.
  bool measure() {
    if (!measure_fluid()) return false;
    fmt::print("  fluid alone at density {:.5g}: eta = {}\n", record_.fluid.density.value,
               with_error(record_.fluid.eta.value, record_.fluid.eta.error));
    fmt::print("  {:>8} {:>9} {:>18} {:>18} {:>18} {:>18} {:>18} {:>8}\n", "edge", "particles",
               "density, far", "mobility", "radius by drag", "by torque", "excluded volume",
               "seconds");
    double excluded = first_guess();
    const double goal =
        of_boxes * record_.relative_error * std::sqrt(static_cast<double>(record_.edges.size()));
    if (stopped_()) return false;
    for (const double edge : record_.edges) {
      if (!measure_in(edge, excluded, goal)) return false;
      excluded = record_.excluded().value;
    }
    return true;
  }

  /// The radius by drag in the smallest box; nothing where it ended early. NaN where the series has none.
  std::optional<Measured> measure_once() {
    if (!measure_fluid()) return {};
    bool complete = false;
    const auto known = [&](const BodyInCell& c) {
      const Measured a = record_.drag(c);
      complete = c.samples >= least_samples &&
                 (a.error <= of_boxes * record_.relative_error * a.value || std::isnan(a.value));
      return complete;
    };
    const BodyInCell cell = measure_body(record_.body, record_.edges.front(), first_guess(),
                                         options_.threads, known, stopped_);
    if (!complete) return {};
    return record_.drag(cell);
  }

 private:
  // Of the radius, eta may have this part of the error, the mean over the boxes the rest.
  static constexpr double of_eta = 0.4, of_boxes = 0.85;

  bool measure_fluid() {
    const MeasuredBody& body = record_.body;
    const auto known = [&](const PureFluid& f) {
      return f.samples >= least_samples &&
             f.eta.error <= of_eta * record_.relative_error * f.eta.value;
    };
    if (!known(record_.fluid)) {
      log_info("measuring the fluid alone");
      // What is there already stays until there is better.
      const PureFluid fluid = measure_pure_fluid(body, options_.threads, known, stopped_);
      if (!known(fluid)) return false;
      record_.fluid = fluid;
    }
    return true;
  }

  // v_ex. Fluid keeps some half of a spacing away from sites; of long bodies some configurations tell.
  double first_guess() const {
    const MeasuredBody& body = record_.body;
    const double ball = ball_volume(
        body.dimension, body.reach + 0.6 * std::pow(body.density, -1.0 / body.dimension));
    if (body.round || record_.take(record_.edges.front()).samples > 0) return ball;
    constexpr std::int64_t some = 8;
    const BodyInCell trial = measure_body(
        body, record_.edges.front(), ball, options_.threads,
        [](const BodyInCell& c) { return c.samples >= some; }, stopped_);
    return trial.samples > 0 ? std::clamp(excluded_volume(trial).value, 0.0, ball) : ball;
  }

  bool measure_in(double edge, double excluded, double goal) {
    const Stopwatch watch;
    bool complete = false;
    const auto known = [&](const BodyInCell& c) {
      const Measured a = record_.drag(c);
      // Without a radius, once there is an error that would tell, none will come.
      complete = c.samples >= least_samples &&
                 (a.error <= goal * a.value || (std::isnan(a.value) && c.translation.error > 0.0));
      return complete;
    };
    BodyInCell cell = record_.take(edge);
    const bool there = known(cell);
    if (!there) {
      log_info(fmt::format("measuring in a box with an edge of {:.6g}", edge));
      cell = measure_body(record_.body, edge, excluded, options_.threads, known, stopped_);
    }
    if (!complete) return false;
    if (std::isnan(record_.drag(cell).value))
      throw SolverError(fmt::format(
          "a box with an edge of {:.6g} is too small (or too large) for the series: the mobility "
          "of {} there, {}, is of no radius below {:.6g}; choose other --boxes",
          edge, record_.body.name, with_error(cell.translation.value, cell.translation.error),
          (record_.body.dimension > 2 ? 0.4 : 0.3) * edge));
    record_.cells.push_back(cell);
    if (!there) write_radius(directory_, record_, false);
    const auto text = [](const Measured& m) { return with_error(m.value, m.error); };
    fmt::print("  {:>8.4g} {:>9} {:>18} {:>18} {:>18} {:>18} {:>18} {:>8.1f}\n", edge,
               cell.particles, text(cell.density), text(cell.translation), text(record_.drag(cell)),
               text(record_.torque(cell)), text(excluded_volume(cell)), watch.seconds());
    std::fflush(stdout);
    return true;
  }

  const CalibrateRadiusOptions& options_;
  RadiusRecord& record_;
  fs::path directory_;
  EarlyEnd stopped_;
};

RadiusRecord read_record(const CalibrateRadiusOptions& options) {
  const Config config = open_case(options.case_path, options.overrides);
  const CaseSettings settings = read_case(config, case_name(options.case_path));
  return settings.dimension == 2 ? read_body_record<2>(options, config, settings)
                                 : read_body_record<3>(options, config, settings);
}

// Which [[pair]] is that of the fluid with the body that is measured: not one with other colloids, of which the fluid has none.
std::size_t pair_with_fluid(const CalibrateRadiusOptions& options, const Config& config,
                            const MeasuredBody& body) {
  const auto pairs = config.tables("pair");
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const std::vector<std::string> ends = pairs[k].texts("species");
    if (std::count(ends.begin(), ends.end(), body.own_species) != 1) continue;
    const std::string& other = ends[ends[0] == body.own_species ? 1 : 0];
    const auto species = config.tables("species");
    if (std::none_of(species.begin(), species.end(), [&](const Config& s) {
          return s.text("name") == other && s.has("count") && s.integer("count") == 0;
        }))
      return k;
  }
  config.fail("pair",
              fmt::format("--find {}: there is no [[pair]] of '{}' with the fluid: give one",
                          options.find, body.own_species));
}

// The same with the seconds that are left of the whole.
CalibrateRadiusOptions left_of(const CalibrateRadiusOptions& options, const Stopwatch& watch) {
  CalibrateRadiusOptions left = options;
  if (left.limit_seconds > 0.0)
    left.limit_seconds = std::max(1e-3, left.limit_seconds - watch.seconds());
  return left;
}

// By secants: the first step is as if a cutoff or core were the radius but for a constant, a friction in proportion. Nothing where
// it ended early.
std::optional<std::string> find_value(const CalibrateRadiusOptions& options) {
  const Stopwatch watch;
  RadiusRecord record = read_record(options);
  const Config config = open_case(options.case_path, options.overrides);
  const std::size_t pair = pair_with_fluid(options, config, record.body);
  const std::string path = fmt::format("pair.{}.{}", pair, options.find);
  const bool length = options.find != "gamma";
  double x = config.tables("pair")[pair].positive(options.find), last_x = 0.0, last_radius = 0.0;
  constexpr int most_trials = 8;
  for (int trial = 0; trial < most_trials; ++trial) {
    CalibrateRadiusOptions with = left_of(options, watch);
    with.overrides.push_back(fmt::format("{}={}", path, x));
    RadiusRecord here = read_record(with);
    here.fluid = record.fluid;
    const auto measured = RadiusCalibrator(with, here, {}).measure_once();
    if (!measured) return {};
    record.fluid = here.fluid;
    const double radius = measured->value;
    fmt::print("  {} = {:<10.6g} radius by drag {}\n", path, x,
               with_error(radius, measured->error));
    std::fflush(stdout);
    if (std::isnan(radius)) break;
    if (std::abs(radius - options.wanted) <= 0.5 * record.relative_error * options.wanted)
      return with.overrides.back();
    double slope = length ? 1.0 : radius / x;
    if (trial > 0) slope = (radius - last_radius) / (x - last_x);
    // Noise, or a friction so large that it no longer matters.
    if (!(slope > (length ? 0.2 : 1e-3 * radius / x))) break;
    last_x = x;
    last_radius = radius;
    x = std::clamp(x + (options.wanted - radius) / slope, 0.4 * x, 2.5 * x);
  }
  config.tables("pair")[pair].fail(
      options.find, fmt::format("no value was found that gives {} a radius of {}: choose another "
                                "key for --find, or another core or friction",
                                record.body.name, options.wanted));
}

std::string conclusion(const RadiusRecord& r) {
  const auto text = [](const Measured& m) { return with_error(m.value, m.error); };
  const Measured a = r.radius(), line = r.at_infinity(), v = r.excluded();
  std::string out =
      fmt::format("\nHydrodynamic radius of {}: {} (mean over the boxes)\n", r.body.name, text(a));
  if (!std::isnan(line.value))
    out +=
        fmt::format("  by a line in 1/edge, which the series should leave level: {}\n", text(line));
  out += fmt::format("  by torque: {}\n", text(r.turning_radius()));
  if (!r.body.round)
    out +=
        "  It is longer than wide: the radius is that of the ball with its mean mobility, over all "
        "directions, and the\n  torque's that of the ball with its mean rotational one\n";
  if (r.body.reach < r.body.cutoff)
    out +=
        "  It is smaller than the cutoff, and so than the cells of the pressure: the drag's radius "
        "may be off by some 5 %\n";
  out += fmt::format("Excluded volume: {}; a ball of the hydrodynamic radius has {:.5g}\n", text(v),
                     ball_volume(r.body.dimension, a.value));
  const double apart = std::abs(line.value - a.value);
  if (apart > 2.0 * line.error && apart > 0.03 * a.value)
    log_warning(
        "the radius depends on the box: take larger ones (--boxes), as at a few cutoffs a fluid "
        "has another viscosity than on long ways (docs/generalised-hydrodynamics.md)");
  out += fmt::format(
      "\n[[{}]]\nname = \"{}\"\n# measured at density {}, eta = {}\nhydrodynamic_radius = {:.5g}"
      "   # +- {:.2g}\nexcluded_volume = {:.5g}   # +- {:.2g}\n",
      r.body.entry, r.body.name, r.body.density, text(r.fluid.eta), a.value, a.error, v.value,
      v.error);
  return out;
}

}  // namespace

int calibrate_radius(const CalibrateRadiusOptions& options) {
  if (!options.find.empty()) {
    catch_signals();
    const Stopwatch watch;
    const std::optional<std::string> found = find_value(options);
    if (!found && interrupted()) return 130;
    if (!found) throw Error("--limit-seconds is over before a value is found", 4);
    CalibrateRadiusOptions with = left_of(options, watch);
    with.find.clear();
    with.overrides.push_back(*found);
    fmt::print("Found --set {}\n", *found);
    return calibrate_radius(with);
  }
  RadiusRecord record = read_record(options);
  const fs::path directory = options.out.empty()
                                 ? fs::path("runs") / (case_name(options.case_path) + "-radius")
                                 : options.out;
  const RunLock lock = prepare_radius_directory(directory, record);
  catch_signals();
  fmt::print("One {} of {} particles, in periodic {} at density {:.5g}, dt = {:.4g}\n",
             record.body.name, record.body.sites, record.body.dimension == 2 ? "squares" : "cubes",
             record.body.density, record.body.dt);
  const bool done = RadiusCalibrator(options, record, directory).measure();
  if (done) write_radius(directory, record, true);
  if (!done && interrupted()) return 130;
  if (!done)
    throw Error(
        fmt::format(
            "--limit-seconds is over before the radius is known to {} %: the boxes that are "
            "done are in {}, and the same command goes on from there",
            100.0 * record.relative_error, (directory / "radius.json").string()),
        4);
  fmt::print("{}\nEverything is in {}\n", conclusion(record), (directory / "radius.json").string());
  return 0;
}

}  // namespace odpd
