#include "odpd/app/calibrate.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "odpd/app/calibration_file.h"
#include "odpd/app/interrupt.h"
#include "odpd/app/report.h"
#include "odpd/app/run_output.h"
#include "odpd/app/simulation.h"
#include "odpd/core/error.h"
#include "odpd/core/log.h"
#include "odpd/core/timer.h"
#include "odpd/pairs/dpd.h"
#include "odpd/pairs/sdpd.h"

namespace odpd {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_measurements = 40;  // in all, those of earlier calls included

// The case with what stands in the way of reading its fluid alone taken out.
Config case_to_calibrate(const CalibrateOptions& options) {
  std::vector<std::string> overrides = options.overrides;
  const Config first = open_case(options.case_path, overrides);
  overrides.emplace_back("start.relax_sweeps=0");
  if (first.table("fluid").has("calibration")) overrides.emplace_back("fluid.calibration=\"\"");
  if (options.eta > 0.0 && first.table("fluid").has("eta"))
    overrides.push_back(fmt::format("fluid.eta={}", options.eta));
  return open_case(options.case_path, overrides);
}

// What the measurements vary and what they keep. Throws ConfigError for what the formulas and this measuring scene do not cover.
std::shared_ptr<const CalibratedModel> calibrated(const Config& fluid, const DpdFluid& dpd,
                                                  int dimension, double density) {
  if (dpd.asked.alpha)
    fluid.fail("alpha", "sets a by gamma, which is being looked for: give a instead");
  if (dpd.p.gamma_perp > 0.0)
    fluid.fail("gamma_perp", "calibration changes gamma alone: leave it out");
  return calibrated_dpd(dpd.p, dimension, density);
}

template <int D>
std::shared_ptr<const CalibratedModel> calibrated(const Config& fluid, const SdpdModel<D>& sdpd) {
  const SdpdFriction& f = sdpd.friction();
  if (f.A != 0.0 && std::abs(f.A - f.B) > 1e-12 * f.A)
    fluid.fail("zeta_b",
               "calibration changes eta, and what bulk viscosity that leaves is not measured: give "
               "fluid.form");
  return calibrated_sdpd(sdpd.fluid(), f, D);
}

template <int D>
void check_fluid(const Config& fluid, const SceneSettings<D>& s) {
  if (s.model->thermal() == false)
    fluid.fail("kT",
               "a fluid at kT = 0 has no viscosity of its own (it rests in whatever "
               "structure it has): give kT > 0");
  if (s.zeta_0 > 0.0)
    log_warning("fluid.zeta_0 is left out of the measurement: it would take momentum away");
  if (s.species.size() > 1)
    log_warning("the fluid of [fluid] is measured, as one species: [[pair]] is left out");
}

// The whole case is built once, so that what is wrong in it is told now.
template <int D>
CalibrationRecord read_record(const CalibrateOptions& options, const Config& config,
                              const CaseSettings& settings) {
  const Simulation<D> simulation(config, settings);
  const SceneSettings<D>& s = simulation.scene().settings();
  const Config fluid = config.table("fluid");
  const DpdFluid* dpd = dpd_fluid(*s.model);
  const auto* sdpd = dynamic_cast<const SdpdModel<D>*>(s.model.get());
  if (dpd == nullptr && sdpd == nullptr)
    fluid.fail("model",
               fmt::format("odpd calibrate finds the friction of a fluid of model = \"dpd\" or "
                           "\"sdpd\", this one's is \"{}\": measure its viscosity in a case with "
                           "an observer of kind = \"viscosity\"",
                           s.model->name()));
  check_fluid(fluid, s);
  // The nominal density, which a count or a start file gives by its number of particles; of SDPD that beside bodies.
  const double density =
      sdpd != nullptr ? sdpd->fluid().state.d_0
      : s.count >= 0 || s.start == StartKind::file
          ? static_cast<double>(simulation.scene().particles().free_count()) / s.fluid_volume()
          : s.density;
  CalibrationRecord record;
  MeasuredFluid& m = record.fluid;
  m.model = dpd != nullptr ? calibrated(fluid, *dpd, D, density) : calibrated(fluid, *sdpd);
  if (options.relative_error > 0.0) record.relative_error = options.relative_error;
  const double asked = dpd != nullptr ? dpd->asked.eta.value_or(0.0) : m.model->friction();
  record.eta = options.eta > 0.0 ? options.eta : asked;
  if (options.measure_only) {
    record.eta = 0.0;
  } else if (record.eta == 0.0) {
    fluid.fail("eta", "no viscosity is asked for: give --eta, or fluid.eta, or --measure-only");
  }
  m.dimension = D;
  m.density = density;
  m.mass = s.mass;
  m.shear_rate = options.shear_rate;
  m.seed = s.seed;
  m.particles = options.particles > 0 ? options.particles
                                      : default_particles(D, m.density, m.model->cutoff());
  if (m.box_edge() < 3.0 * m.model->cutoff())
    throw ConfigError(fmt::format(
        "--particles: {} fill a box with an edge of {:.3g}: three cutoffs ({:.3g}) are needed",
        m.particles, m.box_edge(), 3.0 * m.model->cutoff()));
  return record;
}

// An earlier calibration of the same is gone on with, of something else moved aside.
RunLock prepare_directory(const fs::path& directory, CalibrationRecord& record) {
  const fs::path file = directory / "calibration.json";
  if (!fs::exists(file) || !RunLock::marks(directory)) return prepare_run_directory(directory);
  std::string differs;
  {
    const RunLock lock(directory);
    differs = continue_calibration(file, record);
  }
  if (!differs.empty()) {
    log_info(fmt::format("{} is of another calibration: {}", file.string(), differs));
    return prepare_run_directory(directory);
  }
  log_info(fmt::format("{} measurement(s) are there already", record.measurements.size()));
  return RunLock(directory);
}

class Calibrator {
 public:
  Calibrator(const CalibrateOptions& options, CalibrationRecord& record, fs::path file)
      : options_(options),
        record_(record),
        file_(std::move(file)),
        stopped_(options.limit_seconds) {}

  /// The friction, or nothing where it ended early.
  bool search() {
    const MeasuredFluid& f = record_.fluid;
    head();
    while (const auto plan = next()) {
      if (record_.measurements.size() >= most_measurements)
        throw Error(fmt::format("after {} measurements the friction does not settle: see {}",
                                most_measurements, file_.string()),
                    4);
      const double rate = f.shear_rate > 0.0 ? f.shear_rate : default_shear_rate(f, plan->gamma);
      if (!measure(plan->gamma, rate, plan->relative_error)) return false;
    }
    return true;
  }

  /// At the friction found and twice the rate: a quarter of the time for the same error.
  bool check_thinning(double gamma) {
    for (const ViscosityMeasurement& m : record_.measurements)
      if (m.doubled && m.complete && m.gamma == gamma) return true;
    const MeasuredFluid& f = record_.fluid;
    const double rate = f.shear_rate > 0.0 ? f.shear_rate : default_shear_rate(f, gamma);
    return measure(gamma, 2.0 * rate, record_.relative_error, true);
  }

  void save() const { write_calibration(file_, record_); }

 private:
  // What is still to be measured; of --measure-only that is one friction.
  std::optional<MeasurementPlan> next() const {
    const MeasuredFluid& f = record_.fluid;
    if (record_.eta > 0.0)
      return next_measurement(record_.measurements, record_.eta, f.model->guess(record_.eta),
                              record_.relative_error, f.linear());
    for (const ViscosityMeasurement& m : record_.measurements)
      if (m.counts() && m.relative_error() <= record_.relative_error) return std::nullopt;
    return MeasurementPlan{f.model->friction(), record_.relative_error};
  }

  std::string friction() const { return record_.fluid.model->label(); }

  void head() const {
    fmt::print("  {:>12} {:>24} {:>10} {:>10} {:>10} {:>9}\n", friction(), "eta", "rate", "dt",
               "time", "seconds");
  }

  bool measure(double gamma, double rate, double relative_error, bool doubled = false) {
    log_info(fmt::format("measuring at {} = {:.6g} to {:.2g} %", friction(), gamma,
                         100.0 * relative_error));
    const Stopwatch watch;
    const ViscosityRun run{.gamma = gamma,
                           .shear_rate = rate,
                           .relative_error = relative_error,
                           .seed = record_.fluid.seed + record_.measurements.size(),
                           .threads = options_.threads};
    ViscosityMeasurement m = measure_viscosity(record_.fluid, run, stopped_);
    m.doubled = doubled;
    if (m.time > 0.0) {
      record_.measurements.push_back(m);
      save();
      fmt::print("  {:>12.6g} {:>24} {:>10.4g} {:>10.4g} {:>10.4g} {:>9.1f}{}\n", m.gamma,
                 with_error(m.eta, m.error), m.shear_rate, m.dt, m.time, watch.seconds(),
                 m.complete ? "" : "  cut short");
      std::fflush(stdout);
    }
    return m.complete;
  }

  const CalibrateOptions& options_;
  CalibrationRecord& record_;
  fs::path file_;
  EarlyEnd stopped_;
};

// The measurement at twice the rate against eta, and what that says of the rate itself, if the loss goes with its square.
std::string thinning_text(const CalibrationRecord& r, double gamma, double eta, double error) {
  std::string out;
  for (const ViscosityMeasurement& m : r.measurements) {
    if (!m.doubled || !m.complete || m.gamma != gamma) continue;
    const double change = m.eta / eta - 1.0;
    const double spread = std::hypot(m.error, error) / eta;
    out = fmt::format(
        "At shear rate {:.4g}, twice that of the measurements, eta is {} there: {:+.1f} +- {:.1f} "
        "%, so about a third of that at {:.4g}\n",
        m.shear_rate, with_error(m.eta, m.error), 100.0 * change, 100.0 * spread,
        0.5 * m.shear_rate);
    if (std::abs(change) > 3.0 * spread && std::abs(change) > 3.0 * r.relative_error)
      log_warning(
          fmt::format("the viscosity depends on the shear rate: measure at a lower one, as "
                      "with --shear-rate {:.3g}",
                      0.25 * m.shear_rate));
  }
  return out;
}

std::string lines_to_paste(const CalibrationRecord& r) {
  const MeasuredFluid& f = r.fluid;
  const double rate = f.shear_rate > 0.0 ? f.shear_rate : default_shear_rate(f, r.result->gamma);
  return fmt::format(
      "\n[fluid]\n# measured: eta = {} at shear rate {:.4g}\ndensity = {}\nmass = {}\n{}{} = "
      "{:.6g}\n",
      with_error(r.eta, r.eta * r.result->relative_error), rate, f.density, f.mass, f.model->keys(),
      f.model->key(), r.result->gamma);
}

int conclude_calibration(CalibrationRecord& record, Calibrator& calibrator, const fs::path& file) {
  bool done = calibrator.search();
  double gamma = record.fluid.model->friction(), eta = 0.0, error = 0.0;
  if (done && record.eta > 0.0) {
    record.result = estimate_friction(record.measurements, record.eta, record.fluid.linear());
    gamma = record.result->gamma;
    eta = record.eta;
    error = eta * record.result->relative_error;
    calibrator.save();
  }
  done = done && calibrator.check_thinning(gamma);
  if (record.eta == 0.0)
    for (const ViscosityMeasurement& m : record.measurements)
      if (!m.doubled && m.complete) eta = m.eta, error = m.error;
  if (!done && interrupted()) return 130;
  if (!done)
    throw Error(
        fmt::format("--limit-seconds is over before eta is known to {} %: what was measured "
                    "is in {}, and the same command goes on from there",
                    100.0 * record.relative_error, file.string()),
        4);
  fmt::print("\n{}", thinning_text(record, gamma, eta, error));
  const std::string key = record.fluid.model->label();
  if (record.eta == 0.0) {
    fmt::print("{} = {:.6g}: eta = {}\n", key, gamma, with_error(eta, error));
  } else {
    fmt::print("{} = {} gives eta = {}\n{}", key, with_error(gamma, record.result->gamma_error()),
               with_error(eta, error), lines_to_paste(record));
  }
  fmt::print("\nEverything is in {}\n", file.string());
  return 0;
}

}  // namespace

int calibrate(const CalibrateOptions& options) {
  const Config config = case_to_calibrate(options);
  const std::string name = case_name(options.case_path);
  const CaseSettings settings = read_case(config, name);
  CalibrationRecord record = settings.dimension == 2 ? read_record<2>(options, config, settings)
                                                     : read_record<3>(options, config, settings);
  const fs::path directory =
      options.out.empty() ? fs::path("runs") / (name + "-calibrate") : options.out;
  const RunLock lock = prepare_directory(directory, record);
  catch_signals();
  const fs::path file = directory / "calibration.json";
  const MeasuredFluid& f = record.fluid;
  fmt::print("Sheared by its images in a periodic cube with an edge of {:.4g}, {} particles\n",
             f.box_edge(), f.particles);
  Calibrator calibrator(options, record, file);
  calibrator.save();
  return conclude_calibration(record, calibrator, file);
}

}  // namespace odpd
