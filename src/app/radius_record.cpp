#include "odpd/app/radius_record.h"

#include <fmt/format.h>

#include <algorithm>

#include "odpd/analysis/frozen_pressure.h"
#include "odpd/io/csv.h"
#include "odpd/io/file.h"
#include "odpd/io/json.h"
#include "odpd/version.h"

namespace odpd {

namespace {

JsonObject json_of(const Measured& m) {
  return JsonObject().set("mean", m.value).set("stderr", m.error);
}

Table radius_table(const RadiusRecord& r) {
  Table table;
  table.columns = {"edge",
                   "particles",
                   "samples",
                   "density",
                   "density_error",
                   "translation",
                   "translation_error",
                   "rotation",
                   "rotation_error",
                   "radius",
                   "radius_error",
                   "torque_radius",
                   "torque_radius_error",
                   "excluded_volume",
                   "excluded_volume_error"};
  std::vector<BodyInCell> all = r.cells;
  for (const BodyInCell& c : r.earlier)
    if (std::none_of(r.cells.begin(), r.cells.end(),
                     [&](const BodyInCell& other) { return other.edge == c.edge; }))
      all.push_back(c);
  for (const BodyInCell& c : all) {
    std::vector<double> row{c.edge, static_cast<double>(c.particles),
                            static_cast<double>(c.samples)};
    for (const Measured& m :
         {c.density, c.translation, c.rotation, r.drag(c), r.torque(c), excluded_volume(c)})
      row.insert(row.end(), {m.value, m.error});
    table.rows.push_back(row);
  }
  return table;
}

// What must agree for measurements to be of the same, the estimator among it.
std::string inputs_of(const MeasuredBody& b) {
  return fmt::format(
      "dimension = {}\nseed = {}\ndt = {}\ndensity = {}\npressure_spacing = {}\n[fluid]\n{}{}"
      "[[{}]]\n{}",
      b.dimension, b.seed, b.dt, b.density, pressure_spacing, b.fluid, b.species, b.entry, b.body);
}

}  // namespace

void write_radius(const std::filesystem::path& directory, const RadiusRecord& r, bool complete) {
  const Table table = radius_table(r);
  std::vector<JsonObject> boxes;
  for (const std::vector<double>& row : table.rows) {
    JsonObject box;
    for (std::size_t k = 0; k < row.size(); ++k) box.set(table.columns[k], row[k]);
    boxes.push_back(box);
  }
  JsonObject json;
  json.set("version", ODPD_VERSION).set("body", r.body.name).set("inputs", inputs_of(r.body));
  json.set("sites", r.body.sites).set("reach", r.body.reach);
  json.set("relative_error", r.relative_error);
  json.set("pure_fluid", JsonObject()
                             .set("particles", r.fluid.particles)
                             .set("samples", r.fluid.samples)
                             .set("density", r.fluid.density.value)
                             .set("eta", json_of(r.fluid.eta)));
  json.set("boxes", boxes);
  if (complete)
    json.set("result", JsonObject()
                           .set("hydrodynamic_radius", json_of(r.radius()))
                           .set("extrapolated", json_of(r.at_infinity()))
                           .set("torque_radius", json_of(r.turning_radius()))
                           .set("excluded_volume", json_of(r.excluded())));
  write_file_atomically(directory / "radius.json", json.text() + "\n");
  write_csv(directory / "radius.csv", table);
}

bool continue_radius(const std::filesystem::path& file, RadiusRecord& record) {
  const JsonDocument json(file);
  if (json.text({"inputs"}) != inputs_of(record.body)) return false;
  const auto fluid = [&](const char* name) { return json.number({"pure_fluid", name}); };
  record.fluid = {.density = {fluid("density"), 0.0},
                  .eta = {json.number({"pure_fluid", "eta", "mean"}),
                          json.number({"pure_fluid", "eta", "stderr"})},
                  .particles = static_cast<std::int64_t>(fluid("particles")),
                  .samples = static_cast<std::int64_t>(fluid("samples"))};
  for (std::size_t k = 0; k < json.count({"boxes"}); ++k) {
    const auto number = [&](const std::string& name) {
      return json.number({"boxes", std::to_string(k), name});
    };
    const auto with_its_error = [&](const std::string& name) {
      return Measured{number(name), number(name + "_error")};
    };
    record.earlier.push_back({.dimension = record.body.dimension,
                              .edge = number("edge"),
                              .particles = static_cast<std::int64_t>(number("particles")),
                              .sites = record.body.sites,
                              .translation = with_its_error("translation"),
                              .rotation = with_its_error("rotation"),
                              .density = with_its_error("density"),
                              .samples = static_cast<std::int64_t>(number("samples"))});
  }
  return true;
}

Measured RadiusRecord::shared(Measured (RadiusRecord::*quantity)(const BodyInCell&) const) const {
  Measured mean =
      weighted_mean(of_cells([&](const BodyInCell& c) { return (this->*quantity)(c); }));
  RadiusRecord other = *this;
  other.fluid.eta.value += fluid.eta.error;
  const Measured moved =
      weighted_mean(other.of_cells([&](const BodyInCell& c) { return (other.*quantity)(c); }));
  mean.error = std::hypot(mean.error, moved.value - mean.value);
  return mean;
}

Measured RadiusRecord::at_infinity() const {
  const auto values = of_cells([&](const BodyInCell& c) { return drag(c); });
  return extrapolated(values, std::span(edges).first(values.size()));
}

Measured RadiusRecord::excluded() const {
  return weighted_mean(of_cells([](const BodyInCell& c) { return excluded_volume(c); }));
}

BodyInCell RadiusRecord::take(double edge) const {
  const auto at = std::find_if(earlier.begin(), earlier.end(),
                               [&](const BodyInCell& c) { return c.edge == edge; });
  return at == earlier.end() ? BodyInCell{} : *at;
}

}  // namespace odpd
