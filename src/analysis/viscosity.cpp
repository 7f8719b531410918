#include "odpd/analysis/viscosity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/analysis/helfand.h"
#include "odpd/core/index.h"

namespace odpd {

namespace {

// A component's state within that of another.
class PrefixedWriter : public StateWriter {
 public:
  PrefixedWriter(StateWriter& out, std::string prefix) : out_(out), prefix_(std::move(prefix)) {}
  void write(const std::string& name, const std::vector<double>& values) override {
    out_.write(prefix_ + name, values);
  }
  void write(const std::string& name, const std::vector<std::int64_t>& values) override {
    out_.write(prefix_ + name, values);
  }
  void write_text(const std::string& name, const std::string& text) override {
    out_.write_text(prefix_ + name, text);
  }

 private:
  StateWriter& out_;
  std::string prefix_;
};

class PrefixedReader : public StateReader {
 public:
  PrefixedReader(const StateReader& in, std::string prefix) : in_(in), prefix_(std::move(prefix)) {}
  bool has(const std::string& name) const override { return in_.has(prefix_ + name); }
  std::vector<double> read_doubles(const std::string& name) const override {
    return in_.read_doubles(prefix_ + name);
  }
  std::vector<std::int64_t> read_integers(const std::string& name) const override {
    return in_.read_integers(prefix_ + name);
  }
  std::string read_text(const std::string& name) const override {
    return in_.read_text(prefix_ + name);
  }

 private:
  const StateReader& in_;
  std::string prefix_;
};

// Two walls that face each other across `axis`.
template <int D>
bool facing_walls(const SceneSettings<D>& s, int axis) {
  return s.wall_at(axis, false) >= 0 && s.wall_at(axis, true) >= 0;
}

template <int D>
bool sheared_across(const SceneSettings<D>& s, ViscosityScene& v) {
  for (v.axis = 0; v.axis < D; ++v.axis) {
    if (!facing_walls(s, v.axis)) continue;
    const auto& low = s.walls[index(s.wall_at(v.axis, false))];
    const auto& high = s.walls[index(s.wall_at(v.axis, true))];
    for (v.component = 0; v.component < D; ++v.component)
      if (low.velocity[v.component] != high.velocity[v.component]) return true;
  }
  return false;
}

// Walls with a uniform force along them, or else the first region with a force across its axis.
template <int D>
bool pushed(const SceneSettings<D>& s, ViscosityScene& v) {
  if (!s.force_varies() && s.largest_force() > 0.0) {
    v.component = direction_of(s.body_force);
    for (v.axis = 0; v.axis < D; ++v.axis)
      if (v.axis != v.component && facing_walls(s, v.axis)) return true;
    return false;
  }
  for (const auto& region : s.force_regions) {
    v.axis = region.axis;
    v.component = direction_of(region.force);
    v.from = region.from;
    v.to = region.to;
    if (v.component != v.axis && region.force[v.component] != 0.0) return true;
  }
  return false;
}

Scalar quotient(std::string name, const Scalar* above, const Scalar* below) {
  if (above == nullptr || below->mean == 0.0) return {std::move(name), std::nan(""), std::nan("")};
  const double value = above->mean / below->mean;
  return {std::move(name), value,
          std::abs(value) *
              std::hypot(above->standard_error / above->mean, below->standard_error / below->mean)};
}

}  // namespace

template <int D>
ViscosityScene viscosity_scene(const Scene<D>& scene) {
  using Kind = ViscosityScene::Kind;
  const SceneSettings<D>& s = scene.settings();
  ViscosityScene v;
  if (const auto& shear = s.box.shear) {
    v.axis = shear->gradient;
    v.component = shear->flow;
    v.to = s.box.size[v.axis];
    // A body that is held takes up some of the stress, one that is pushed or turned adds to it.
    if (shear->frequency == 0.0 && shear->rate != 0.0 && !s.held() && !s.loaded())
      v.kind = Kind::images;
    return v;
  }
  if (sheared_across(s, v)) {
    v.kind = Kind::sheared;
  } else if (s.force_wave.number > 0) {
    if (s.force_wave.shape != FlowWave::Shape::sine) return v;
    v.kind = Kind::sine;
    v.axis = s.force_wave.along;
    v.component = direction_of(s.body_force);
    v.from = scene.fluid_low()[v.axis];
    v.to = scene.fluid_high()[v.axis];
    return v;
  } else if (pushed(s, v)) {
    v.kind = Kind::parabola;
  } else if (!s.driven() && s.box.periodic_directions() == D && scene.largest_kT() > 0.0 &&
             scene.conserves_momentum()) {
    v.kind = Kind::at_rest;
  }
  // One cutoff clear of the surfaces, where walls order the fluid, or of where the force changes.
  if (v.to == v.from) {
    v.axis = std::min(v.axis, D - 1);
    v.from = scene.fluid_low()[v.axis];
    v.to = scene.fluid_high()[v.axis];
  }
  v.from += scene.model().cutoff();
  v.to -= scene.model().cutoff();
  return v;
}

template <int D>
Viscosity<D>::Viscosity(ObserverSettings settings, const ViscositySettings& viscosity,
                        const Scene<D>& scene, double dt)
    : Observer<D>(std::move(settings)),
      kind_(viscosity_scene(scene)),
      scene_(scene),
      control_tolerance_(viscosity.control.tolerance) {
  using Kind = ViscosityScene::Kind;
  const std::int64_t every = this->settings().every;
  if (kind_.has_profile()) {
    ProfileSettings p{.axis = kind_.axis, .bins = viscosity.bins, .component = kind_.component};
    p.fit = kind_.kind == Kind::sheared ? ProfileFit::linear
            : kind_.kind == Kind::sine  ? ProfileFit::sine
                                        : ProfileFit::parabola;
    p.fit_from = kind_.from;
    p.fit_to = kind_.to;
    parts_.push_back(std::make_unique<Profile<D>>(
        ObserverSettings{.kind = "profile", .name = "profile", .every = every}, p, scene));
  }
  if (kind_.kind == Kind::sheared)
    parts_.push_back(std::make_unique<WallForce<D>>(
        ObserverSettings{.kind = "wall-force", .name = "wall", .every = every}, scene));
  if (kind_.kind == Kind::images && viscosity.control.every > 0)
    controlled_.emplace(3);
  else if (kind_.kind == Kind::sheared || kind_.kind == Kind::images)
    parts_.push_back(std::make_unique<Stress<D>>(
        ObserverSettings{.kind = "stress", .name = "stress", .every = every}, StressBins{}, scene));
  if (kind_.kind == Kind::at_rest)
    growth_.emplace(ModeGrowth::Settings{.window = viscosity.window,
                                         .fit_from = viscosity.fit_from,
                                         .dt = dt,
                                         .kT = scene.largest_kT(),
                                         .waves = 1,
                                         .modes_per_wave = index(D * (D - 1)),
                                         .control_every = viscosity.control.every,
                                         .drift_adds = true});
}

template <int D>
std::unique_ptr<Observer<D>> Viscosity<D>::make(const ObserverEntry<D>& entry) {
  ObserverSettings settings = entry.settings();
  const Config& config = entry.config;
  const ViscosityScene kind = viscosity_scene(entry.scene);
  if (kind.kind == ViscosityScene::Kind::none)
    config.fail("kind",
                "nothing in this scene shows a viscosity: move a wall, shear it steadily, drive "
                "the fluid along its walls or by body_force.wave, or leave a fully periodic fluid "
                "of kT > 0 at rest. Taylor-Green vortices and a flow that decays are for the "
                "observer 'wave'");
  ViscositySettings v;
  if (kind.has_profile()) {
    v.bins = config.positive_integer("bins", 20);
    const ProfileSettings p{
        .axis = kind.axis, .bins = v.bins, .fit_from = kind.from, .fit_to = kind.to};
    if (!(kind.from < kind.to))
      config.fail("kind",
                  "no part of the stream is one cutoff clear of both its ends, where the profile "
                  "is fitted: make it wider than two cutoffs");
    if (fitted_bins(p, entry.scene) < 4)
      config.fail("bins", fmt::format("at least 4 bins with centres between {} and {} are needed: "
                                      "use more, or a wider stream",
                                      kind.from, kind.to));
  }
  if (kind.needs_every_step()) {
    v.window = config.positive("window", v.window);
    v.fit_from = config.non_negative("fit_from", 0.4 * v.window);
    if (v.fit_from >= v.window) config.fail("fit_from", "must be less than window");
    if (settings.every != 1)
      config.fail("every", "must be 1: the stress is integrated over every step");
    require_two_steps(config, v.window, entry.clock.dt);
    v.control = read_control(config, v.window, entry.clock.dt);
  } else if (kind.kind == ViscosityScene::Kind::images) {
    v.control = read_control(config);
  }
  if (v.control.every > 0 &&
      (entry.scene.settings().mass > 0.0 || (entry.in_time && !entry.two_stages) ||
       entry.scene.largest_kT() == 0.0))
    config.fail("control",
                "knows what the noise does to particles without mass, in schemes of two stages: "
                "set fluid.mass = 0, kT > 0 and the "
                "integrator 'trapezoidal' or 'midpoint', or leave control out");
  return std::make_unique<Viscosity<D>>(std::move(settings), v, entry.scene, entry.clock.dt);
}

template <int D>
void Viscosity<D>::measure(const Clock& clock, const Particles<D>& particles,
                           const StepRecord<D>& record) {
  for (auto& part : parts_) part->measure(clock, particles, record);
  if (controlled_) {
    const HelfandControl control =
        shear_control(particles, record, kind_.component, kind_.axis, control_tolerance_);
    const std::vector<double> stress = stress_of(scene_, particles, record, StressBins{});
    double plain = 0.0;
    for (std::size_t part = 0; part < stress_parts; ++part)
      plain += stress[(part * D + index(kind_.axis)) * D + index(kind_.component)];
    const double volume = scene_.fluid_volume(), rate = scene_.box().shear->rate;
    const double made = control.made[0] / (volume * record.dt);
    row_ = {plain / rate, (plain - made) / rate, control.response[0] / volume};
    controlled_->add(row_);
  }
  if (!growth_) return;
  HelfandControl control;
  if (growth_->control_is_due()) control = helfand_control(particles, record, control_tolerance_);
  growth_->add(helfand_growth(scene_, particles, record), control.made, control.response);
}

template <int D>
Scalar Viscosity<D>::helfand(const std::string& what, const ModeGrowth::Estimate& growth) const {
  const double volume = scene_.fluid_volume();
  return {this->named(what), growth.mean / volume, growth.error / volume};
}

template <int D>
Table Viscosity<D>::growth_table() const {
  Table table;
  table.comment = {
      "growth of the integrated stress, <(dG)^2>/(2 V kT), with control less what its noise is "
      "known "
      "to make beyond its mean; its slope is the viscosity"};
  table.columns = {"lag", "growth", "growth_error"};
  for (std::size_t lag = 1; lag <= growth_->lags(); ++lag) {
    const double t = growth_->lag_time(lag);
    const Scalar eta = helfand("at_lag", growth_->at_lag(0, lag));
    table.rows.push_back({t, t * eta.mean, t * eta.standard_error});
  }
  return table;
}

template <int D>
std::vector<Scalar> Viscosity<D>::routes(Results& results) const {
  const std::string& name = this->settings().name;
  if (growth_) {
    if (growth_->samples() > 0) {
      Curve curve{.title = "measured", .x = {}, .y = {}, .error = {}};
      const Table table = growth_table();
      for (const auto& row : table.rows) {
        curve.x.push_back(row[0]);
        curve.y.push_back(row[1]);
      }
      results.tables.emplace_back(name, table);
      results.charts.emplace_back(name, Chart{.title = "Growth of the integrated stress",
                                              .x_label = "lag",
                                              .y_label = "<dG^2> / (2 V kT)",
                                              .curves = {std::move(curve)}});
    }
    if (growth_->controlled()) {
      results.scalars.push_back(helfand("plain", growth_->plain(0)));
      results.scalars.push_back(helfand("frozen", growth_->frozen(0)));
      if (!scene_.bonds().empty()) results.notes.push_back(control_with_bonds(name));
    }
    return {helfand("helfand", growth_->chi(0))};
  }
  if (controlled_) {
    const auto column = [&](const char* what, std::size_t k) {
      return Scalar{this->named(what), controlled_->mean(k), controlled_->standard_error(k)};
    };
    results.scalars.push_back(column("plain", 0));
    results.scalars.push_back(column("frozen", 2));
    return {column("stress", 1)};
  }
  Results parts;
  for (const auto& part : parts_) part->add_results(parts);
  results.notes.insert(results.notes.end(), parts.notes.begin(), parts.notes.end());
  const char axis = "xyz"[kind_.axis], component = "xyz"[kind_.component];
  const Scalar* stress = parts.find(fmt::format("stress.{}{}", axis, component));
  if (kind_.kind == ViscosityScene::Kind::images) {
    const Scalar rate{"rate", scene_.box().shear->rate, 0.0};
    return {quotient(name + ".stress", stress, &rate)};
  }
  if (kind_.kind != ViscosityScene::Kind::sheared) {
    const Scalar* scalar = parts.find("profile.viscosity");
    const bool sine = kind_.kind == ViscosityScene::Kind::sine;
    const std::string route = name + (sine ? ".sine" : ".profile");
    if (scalar == nullptr) return {{route}};
    return {{route, scalar->mean, scalar->standard_error}};
  }
  const Scalar* slope = parts.find("profile.slope");
  results.scalars.push_back({name + ".shear_rate", slope->mean, slope->standard_error});
  return {
      quotient(name + ".wall", parts.find(fmt::format("wall.shear_stress.{}", component)), slope),
      quotient(name + ".stress", stress, slope)};
}

template <int D>
void Viscosity<D>::add_results(Results& results) const {
  const std::vector<Scalar> all = routes(results);
  const std::string& name = this->settings().name;
  Scalar best{name == "viscosity" ? name : name + ".viscosity", std::nan(""), std::nan("")};
  std::string route;
  for (const Scalar& scalar : all) {
    results.scalars.push_back(scalar);
    const bool better =
        std::isnan(best.standard_error) || scalar.standard_error < best.standard_error;
    if (std::isnan(scalar.mean) || !better) continue;
    best.mean = scalar.mean;
    best.standard_error = scalar.standard_error;
    route = scalar.name;
  }
  if (!route.empty())
    results.notes.push_back(
        fmt::format("{} is {}, the route of smallest standard error", best.name, route));
  results.scalars.push_back(std::move(best));
}

template <int D>
std::vector<std::string> Viscosity<D>::series_columns() const {
  std::vector<std::string> columns;
  for (const auto& part : parts_)
    for (const std::string& column : part->series_columns())
      columns.push_back(part->settings().name + "_" + column);
  if (controlled_) return {"plain", "stress", "frozen"};
  if (growth_)
    for (std::size_t k = 0; k < growth_->integral().size(); ++k)
      columns.push_back(fmt::format("integral_{}", k));
  return columns;
}

template <int D>
std::vector<double> Viscosity<D>::series_row() const {
  if (growth_) return growth_->integral();
  if (controlled_) return row_;
  std::vector<double> row;
  for (const auto& part : parts_) {
    const std::vector<double> values = part->series_row();
    row.insert(row.end(), values.begin(), values.end());
  }
  return row;
}

template <int D>
void Viscosity<D>::save(StateWriter& out) const {
  for (const auto& part : parts_) {
    PrefixedWriter prefixed(out, part->settings().name + "/");
    part->save(prefixed);
  }
  if (growth_) growth_->save(out);
  if (controlled_) controlled_->save(out, "controlled");
}

template <int D>
void Viscosity<D>::load(const StateReader& in) {
  for (auto& part : parts_) part->load(PrefixedReader(in, part->settings().name + "/"));
  if (growth_) growth_->load(in);
  if (controlled_) controlled_->load(in, "controlled");
}

template ViscosityScene viscosity_scene<2>(const Scene<2>&);
template ViscosityScene viscosity_scene<3>(const Scene<3>&);
template class Viscosity<2>;
template class Viscosity<3>;

}  // namespace odpd
