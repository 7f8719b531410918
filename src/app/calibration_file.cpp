#include "odpd/app/calibration_file.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "odpd/core/error.h"
#include "odpd/io/file.h"
#include "odpd/io/json.h"
#include "odpd/version.h"

namespace odpd {

namespace {

// What must agree for measurements to be of the same.
std::vector<std::pair<std::string, double>> inputs_of(const CalibrationRecord& r) {
  const MeasuredFluid& f = r.fluid;
  std::vector<std::pair<std::string, double>> inputs{
      {"dimension", f.dimension}, {"density", f.density}, {"mass", f.mass}};
  const auto of_model = f.model->inputs();
  inputs.insert(inputs.end(), of_model.begin(), of_model.end());
  inputs.insert(inputs.end(), {{"eta", r.eta},
                               {"shear_rate", f.shear_rate},
                               {"particles", static_cast<double>(f.particles)},
                               {"seed", static_cast<double>(f.seed)}});
  if (r.eta == 0.0) inputs.emplace_back(f.model->label(), f.model->friction());
  return inputs;
}

JsonObject json_of_measurement(const std::string& friction, const ViscosityMeasurement& m) {
  return JsonObject()
      .set(friction, m.gamma)
      .set("eta", m.eta)
      .set("eta_stderr", m.error)
      .set("shear_rate", m.shear_rate)
      .set("dt", m.dt)
      .set("time", m.time)
      .set("seed", m.seed)
      .set("complete", m.complete ? 1 : 0)
      .set("doubled_rate", m.doubled ? 1 : 0);
}

}  // namespace

void write_calibration(const std::filesystem::path& file, const CalibrationRecord& record) {
  const std::string friction = record.fluid.model->label();
  JsonObject inputs;
  for (const auto& [name, value] : inputs_of(record)) inputs.set(name, value);
  if (const std::string text = record.fluid.model->text(); !text.empty()) inputs.set("fluid", text);
  std::vector<JsonObject> measurements;
  for (const ViscosityMeasurement& m : record.measurements)
    measurements.push_back(json_of_measurement(friction, m));
  JsonObject json;
  json.set("program", "odpd " ODPD_VERSION)
      .set("inputs", inputs)
      .set("relative_error", record.relative_error)
      .set("box_edge", record.fluid.box_edge())
      .set("measurements", measurements);
  if (const auto& result = record.result) {
    const double eta = record.eta;
    json.set("result", JsonObject()
                           .set(friction, result->gamma)
                           .set(friction + "_stderr", result->gamma_error())
                           .set("eta", eta)
                           .set("eta_stderr", eta * result->relative_error)
                           .set("exponent", result->exponent));
  }
  write_file_atomically(file, json.text() + "\n");
}

std::string continue_calibration(const std::filesystem::path& file, CalibrationRecord& record) {
  if (!std::filesystem::exists(file)) return {};
  const JsonDocument json(file);
  const auto inputs = inputs_of(record);
  for (const auto& [name, value] : inputs)
    if (const double before = json.number({"inputs", name}); before != value)
      return fmt::format("{} was {} and is {}", name, before, value);
  const std::string text = record.fluid.model->text();
  if (const std::string before = json.text({"inputs", "fluid"}); before != text)
    return fmt::format("the fluid was {} and is {}", before, text);
  if (json.keys({"inputs"}).size() != inputs.size() + (text.empty() ? 0 : 1))
    return "it was for another purpose";
  for (std::size_t k = 0; k < json.count({"measurements"}); ++k) {
    const auto number = [&](const char* name) {
      return json.number({"measurements", std::to_string(k), name});
    };
    record.measurements.push_back({.gamma = number(record.fluid.model->label().c_str()),
                                   .eta = number("eta"),
                                   .error = number("eta_stderr"),
                                   .shear_rate = number("shear_rate"),
                                   .dt = number("dt"),
                                   .time = number("time"),
                                   .seed = static_cast<std::uint64_t>(number("seed")),
                                   .complete = number("complete") == 1.0,
                                   .doubled = number("doubled_rate") == 1.0});
  }
  return {};
}

std::optional<Calibration> read_calibration(const Config& config) {
  const Config fluid = config.table("fluid");
  if (!names_calibration(fluid)) return std::nullopt;
  const std::string make = "make it with odpd calibrate CASE";
  const std::string file = fluid.file("calibration").string();
  try {
    const JsonDocument json(fluid.file_text("calibration", make), file);
    const auto input = [&](const char* name) { return json.number({"inputs", name}); };
    Calibration c;
    c.file = file;
    c.density = input("density");
    c.mass = input("mass");
    c.fluid.kT = input("kT");
    c.fluid.cutoff = input("cutoff");
    c.fluid.a = input("a");
    c.fluid.s_bar = input("s_bar");
    c.fluid.s = input("s");
    c.fluid.gamma_far = input("rattler_gamma");
    c.fluid.cutoff_far = input("rattler_cutoff");
    c.fluid.gamma = json.number({"result", "gamma"});
    c.gamma_error = json.number({"result", "gamma_stderr"});
    c.eta = json.number({"result", "eta"});
    c.eta_error = json.number({"result", "eta_stderr"});
    if (!(c.fluid.gamma > 0.0) || !(c.eta > 0.0) || std::isnan(input("dimension")))
      fluid.fail("calibration",
                 fmt::format("{} holds no friction for a viscosity: {} --eta ...", c.file, make));
    c.dimension = static_cast<int>(input("dimension"));
    return c;
  } catch (const IoError& e) {
    fluid.fail("calibration", fmt::format("{}; {}", e.what(), make));
  }
}

}  // namespace odpd
