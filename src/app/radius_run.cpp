#include "odpd/app/radius_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "odpd/analysis/block_average.h"
#include "odpd/analysis/frozen_pressure.h"
#include "odpd/app/calibrated_model.h"
#include "odpd/app/calibration_run.h"
#include "odpd/app/simulation.h"
#include "odpd/core/log.h"
#include "odpd/core/parallel.h"
#include "odpd/pairs/dpd.h"

namespace odpd {

namespace {

// Steps between two configurations, and before the first: density and structure settle within some explicit limits of the step.
constexpr std::int64_t between_samples = 20, settling = 400;

// Lines of a table of the case, without some of its keys.
std::string lines_of(const ConfigValues& values, const std::set<std::string>& without) {
  std::string lines;
  for (const auto& [path, value] : values) {
    const std::string key = path.substr(0, path.find('.'));
    if (!without.contains(key)) lines += fmt::format("{} = {}\n", path, value);
  }
  return lines;
}

std::string tables_of(const Config& config, const std::string& name) {
  std::string text;
  if (config.has(name))
    for (const ConfigValues& element : config.elements(name))
      text += fmt::format("[[{}]]\n{}", name, lines_of(element, {}));
  return text;
}

// Names, and how the fluid's particles are shared among them whatever their number.
std::string species_text(const std::vector<SpeciesSettings>& species) {
  std::string text;
  double counted = 0.0;
  const bool spin = std::any_of(species.begin(), species.end(),
                                [](const SpeciesSettings& s) { return s.lever_radius > 0.0; });
  for (const SpeciesSettings& s : species) counted += std::max(0.0, static_cast<double>(s.count));
  for (const SpeciesSettings& s : species)
    text += fmt::format("[[species]]\nname = \"{}\"\n", s.name) +
            (spin ? fmt::format("lever_radius = {}\n", s.lever_radius) : "") +
            (s.count == 0  ? "count = 0\n"
             : s.count > 0 ? fmt::format("fraction = {}\n", static_cast<double>(s.count) / counted)
             : s.fraction < 1.0 ? fmt::format("fraction = {}\n", s.fraction)
                                : "");
  return species.size() > 1 || spin ? text : std::string{};
}

// Keys of [fluid] that friction across lines of centres needs.
std::string lines_of_spin(const ConfigValues& fluid) {
  std::string lines;
  for (const auto& [key, value] : fluid)
    if (key == "lever_radius" || key == "antisymmetric_stress")
      lines += fmt::format("{} = {}\n", key, value);
  return lines;
}

template <int D>
std::string fluid_lines(const Config& portable, const SceneSettings<D>& s, const MeasuredBody& m) {
  // What physical inputs and calibrations came to, as these go by a density.
  if (const DpdFluid* dpd = dpd_fluid(*s.model))
    return calibrated_dpd(dpd->p, D, m.density)->keys() +
           fmt::format("gamma = {}\ngamma_perp = {}\n", dpd->p.gamma, dpd->p.gamma_perp) +
           lines_of_spin(portable.values("fluid"));
  const std::string lines =
      lines_of(portable.values("fluid"), {"density", "count", "reference_density", "mass", "rho",
                                          "zeta_0", "zeta_0_under_flow", "calibration"});
  return m.fills_space ? lines + fmt::format("reference_density = {}\n", m.density) : lines;
}

// Which [[body]], or which [[molecule]] of one particle.
struct Chosen {
  bool molecule = false;
  std::size_t at = 0;
};

template <int D>
Chosen choose_body(const Config& config, const SceneSettings<D>& s, const std::string& name) {
  std::vector<std::string> names;
  std::vector<Chosen> free;
  for (std::size_t k = 0; k < s.bodies.size(); ++k) {
    if (s.bodies[k].motion != BodyMotion::free) continue;
    names.push_back(s.bodies[k].name);
    free.push_back({false, k});
  }
  for (std::size_t k = 0; k < s.molecules.size(); ++k) {
    if (s.molecules[k].beads() > 1) continue;
    names.push_back(s.molecules[k].name);
    free.push_back({true, k});
  }
  if (free.empty())
    config.fail("body",
                "--radius measures the drag of a free body, or of a [[molecule]] of one particle, "
                "and there is none here");
  if (name.empty() && free.size() > 1)
    config.fail("body", fmt::format("say which one, as --radius {}: {} are free", names.front(),
                                    fmt::join(names, ", ")));
  const std::string& wanted = name.empty() ? names.front() : name;
  const auto found = std::find(names.begin(), names.end(), wanted);
  if (found == names.end())
    config.fail("body", fmt::format("--radius {}: there is no free [[body]] of that name, but {}",
                                    wanted, fmt::join(names, ", ")));
  return free[static_cast<std::size_t>(found - names.begin())];
}

// As far in one direction as in the others, nearly.
template <int D>
bool is_round(const std::vector<Vec<D>>& shape) {
  Vec<D> squares{};
  for (const Vec<D>& p : shape)
    for (int c = 0; c < D; ++c) squares[c] += p[c] * p[c];
  double sum = 0.0, largest = 0.0;
  for (const double s : squares.x) sum += s, largest = std::max(largest, s);
  constexpr double nearly = 1.2;
  return largest < nearly * sum / D;
}

template <int D>
void check_measurable(const Config& config, const Scene<D>& scene, const Chosen& chosen) {
  const Config fluid = config.table("fluid");
  const SceneSettings<D>& s = scene.settings();
  if (!s.model->thermal())
    fluid.fail("kT", "configurations are sampled at equilibrium, which needs kT > 0");
  if (s.mass > 0.0)
    fluid.fail("mass",
               "configurations and friction are those without mass, and so are measured: add "
               "--set fluid.mass=0.0 (with physical inputs that need a mass give gamma, a, s)");
  if (s.molecules.size() > (chosen.molecule ? 1 : 0))
    log_warning("[[molecule]] is left out: the radius is measured in the fluid alone");
  if (!chosen.molecule && !s.bodies[chosen.at].shapes.empty())
    config.tables("body")[chosen.at].fail(
        "radius",
        "bodies of several sizes have several radii: choose one, as by --set "
        "body.0.radius=1.0");
}

template <int D>
double reach_of_particle(const Scene<D>& scene, const MoleculeSettings<D>& m) {
  const PressureRange range = pressure_range(scene);
  const std::size_t species = range.colloid.size();
  double reach = 0.0;
  for (std::size_t other = 0; other < species && !range.reaches.empty(); ++other)
    if (range.colloid[other] == 0)
      reach = std::max(reach, range.reaches[index(m.species[0]) * species + other]);
  return std::max(0.0, reach - 0.5 * range.reach);
}

// Of the fluid between the bodies of the case, where all of these say what they take from it; else over all the space.
template <int D>
double density_between(const Scene<D>& scene) {
  const SceneSettings<D>& s = scene.settings();
  double excluded = 0.0, balls = 0.0;
  bool known = true;
  for (const BodySettings<D>& b : s.bodies) {
    const auto bodies = static_cast<double>(b.bodies());
    known = known && b.excluded_volume > 0.0;
    excluded += bodies * b.excluded_volume;
    balls += bodies * unit_ball_volume<D> * std::pow(b.radius(), D);
  }
  for (const MoleculeSettings<D>& m : s.molecules) {
    if (m.beads() > 1) continue;
    const auto colloids = static_cast<double>(m.molecules());
    known = known && m.excluded_volume > 0.0;
    excluded += colloids * m.excluded_volume;
    balls += colloids * unit_ball_volume<D> * std::pow(reach_of_particle(scene, m), D);
  }
  const double space = s.fluid_volume();
  const std::int64_t fluid = s.count >= 0 || s.start == StartKind::file
                                 ? scene.particles().free_count() - s.molecule_beads()
                                 : std::llround(s.density * space);
  constexpr double some = 0.05;
  if (!known && balls > some * space)
    log_warning(
        fmt::format("bodies take some {:.2g} of the space, and how much exactly is not given: the "
                    "fluid is measured at the density {:.5g} of all the space, but is denser "
                    "between them; give each [[body]] its excluded_volume and calibrate again",
                    balls / space, static_cast<double>(fluid) / space));
  return static_cast<double>(fluid) / (known ? space - excluded : space);
}

// Small steps cost little beside the solves of the mobility, and sample the better.
template <int D>
double measuring_step(const Scene<D>& scene, double dt) {
  const auto limit = scene.explicit_step_limit();
  return limit ? std::min(dt, 0.15 * *limit) : dt;
}

// All of it but the observers and the body. `count`: of fluid particles.
std::string scene_text(const MeasuredBody& m, double edge, std::int64_t count) {
  std::string edges, periodic;
  for (int c = 0; c < m.dimension; ++c) {
    edges += fmt::format("{}{}", c > 0 ? ", " : "", edge);
    periodic += c > 0 ? ", true" : "true";
  }
  return fmt::format(
      "dimension = {}\nseed = {}\n[box]\nsize = [{}]\nperiodic = [{}]\n[fluid]\n{}count = {}\n{}"
      "[integrator]\nname = \"trapezoidal\"\ndt = {}\n[solver]\ntolerance = 1e-4\n"
      "[run]\nequilibrate = {}\nduration = {}\n",
      m.dimension, m.seed, edges, periodic, m.fluid, count, m.species, m.dt,
      static_cast<double>(settling) * m.dt, 1e12 * m.dt);
}

std::string body_text(const MeasuredBody& m, double edge) {
  std::string middle;
  for (int c = 0; c < m.dimension; ++c)
    middle += fmt::format("{}{}", c > 0 ? ", " : "", 0.5 * edge);
  return fmt::format(
      "[[{}]]\n{}positions = [{{ at = [{}] }}]\n[[observe]]\nkind = \"mobility\"\nevery = {}\n",
      m.entry, m.body, middle, between_samples);
}

Measured measured(const Results& results, const std::string& name) {
  const Scalar* s = results.find(name);
  return {s->mean, s->standard_error};
}

// Runs until `look` says it is enough, which is asked after each sample.
template <int D>
void sample_until(Simulation<D>& simulation, const std::function<bool()>& look,
                  const std::function<bool()>& stop) {
  bool enough = false;
  simulation.run([&] { return enough || stop(); },
                 [&] {
                   const Clock& clock = simulation.clock();
                   if (clock.measuring() && clock.measured_steps() % between_samples == 0)
                     enough = look();
                 });
}

template <int D>
PureFluid pure_fluid_in(const MeasuredBody& m, int threads,
                        const std::function<bool(const PureFluid&)>& enough,
                        const std::function<bool()>& stop) {
  const auto usual = static_cast<double>(default_particles(D, m.density, m.cutoff));
  const double unit = pressure_spacing * m.cutoff;
  const double edge = unit * std::ceil(std::pow(usual / m.density, 1.0 / D) / unit);
  const std::int64_t count = std::llround(m.density * std::pow(edge, D));
  const Config config = Config::from_text(
      scene_text(m, edge, count) + fmt::format("[[observe]]\nkind = \"high-frequency-viscosity\"\n"
                                               "every = {}\n",
                                               between_samples),
      "measuring scene");
  Simulation<D> simulation(config, read_case(config, "measuring scene"));
  set_threads(threads, simulation.scene().particles().size());
  PureFluid fluid;
  fluid.particles = simulation.scene().particles().size();
  fluid.density.value = static_cast<double>(fluid.particles) / simulation.scene().box().volume();
  sample_until(
      simulation,
      [&] {
        fluid.eta = measured(simulation.results(), "high-frequency-viscosity.eta");
        ++fluid.samples;
        return enough(fluid);
      },
      stop);
  return fluid;
}

// Free particles beyond `far` from the body's centre, or from the single particle.
template <int D>
double count_far(const Scene<D>& scene, double far) {
  const Particles<D>& particles = scene.particles();
  const Vec<D> centre =
      particles.bodies.empty()
          ? particles.position[index(particles.index_of_id()[index(scene.molecules()[0].first)])]
          : particles.bodies[0].pose.centre;
  double count = 0.0;
  for (std::size_t i = 0; i < particles.position.size(); ++i)
    if (particles.is_free(i) && norm(scene.box().separation(particles.position[i], centre)) > far)
      count += 1.0;
  return count;
}

template <int D>
BodyInCell body_in(const MeasuredBody& m, double edge, double excluded, int threads,
                   const std::function<bool(const BodyInCell&)>& enough,
                   const std::function<bool()>& stop) {
  const double volume = std::pow(edge, D), far = m.far(edge);
  const Config config = Config::from_text(
      scene_text(m, edge, std::llround(m.density * (volume - excluded))) + body_text(m, edge),
      "measuring scene");
  Simulation<D> simulation(config, read_case(config, "measuring scene"));
  set_threads(threads, simulation.scene().particles().size());
  BodyInCell cell{.dimension = D,
                  .edge = edge,
                  .particles = simulation.scene().particles().size(),
                  .sites = m.sites};
  BlockAverage density;
  const double far_volume = volume - unit_ball_volume<D> * std::pow(far, D);
  sample_until(
      simulation,
      [&] {
        density.add(std::array{count_far(simulation.scene(), far) / far_volume});
        const Results results = simulation.results();
        cell.translation = measured(results, "mobility." + m.name + ".translation");
        cell.rotation = measured(results, "mobility." + m.name + ".rotation");
        cell.density = {density.mean(0), density.standard_error(0)};
        cell.samples = density.samples();
        return enough(cell);
      },
      stop);
  return cell;
}

}  // namespace

// Whole spacings of the pressure's grid, as the fluid's viscosity depends on it.
std::vector<double> MeasuredBody::default_edges() const {
  const double unit = pressure_spacing * cutoff;
  // Sites of a sphere reach a per cent or two beyond its radius: no larger box for that.
  const double slack = 0.25 * cutoff;
  std::vector<double> edges;
  for (const double multiple :
       dimension > 2 ? std::array{4.0, 5.0, 6.0} : std::array{4.0, 6.0, 8.0}) {
    const double least = edges.empty() ? 0.0 : edges.back() / unit + 1.0;
    edges.push_back(unit *
                    std::max(least, std::ceil((multiple * (reach + 0.5 * cutoff) - slack) / unit)));
  }
  return edges;
}

double MeasuredBody::far(double edge) const { return std::min(reach + 1.5 * cutoff, 0.5 * edge); }

template <int D>
MeasuredBody measured_body(const Config& config, const Scene<D>& scene, double dt,
                           const std::string& name) {
  const SceneSettings<D>& s = scene.settings();
  const Chosen chosen = choose_body(config, s, name);
  check_measurable(config, scene, chosen);
  const Config portable = Config::from_text(portable_case(config), "case.toml");
  const auto reference = s.model->reference_state(0.0);
  MeasuredBody m;
  m.dimension = D;
  m.entry = chosen.molecule ? "molecule" : "body";
  m.name = chosen.molecule ? s.molecules[chosen.at].name : s.bodies[chosen.at].name;
  const std::int32_t species =
      chosen.molecule ? s.molecules[chosen.at].species[0] : s.bodies[chosen.at].species;
  m.own_species = s.species[index(species)].name;
  m.fills_space = reference && reference->spacing > 0.0;
  m.density = reference ? reference->density : density_between(scene);
  m.fluid = fluid_lines(portable, s, m);
  m.species = species_text(s.species) + tables_of(portable, "pair");
  m.body = lines_of(portable.elements(m.entry)[chosen.at],
                    {"positions", "count", "fraction", "fraction_of", "clearance", "force",
                     "torque", "hydrodynamic_radius", "excluded_volume"});
  if (chosen.molecule) {
    m.sites = 1;
    m.reach = reach_of_particle(scene, s.molecules[chosen.at]);
  } else {
    const BodySettings<D>& body = s.bodies[chosen.at];
    m.sites = static_cast<std::int64_t>(body.shape.size());
    m.reach = body.radius();
    m.round = is_round<D>(body.shape);
  }
  m.cutoff = pressure_range(scene).reach;
  m.dt = measuring_step(scene, dt);
  m.seed = s.seed;
  return m;
}

PureFluid measure_pure_fluid(const MeasuredBody& body, int threads,
                             const std::function<bool(const PureFluid&)>& enough,
                             const std::function<bool()>& stop) {
  return body.dimension == 2 ? pure_fluid_in<2>(body, threads, enough, stop)
                             : pure_fluid_in<3>(body, threads, enough, stop);
}

BodyInCell measure_body(const MeasuredBody& body, double edge, double excluded, int threads,
                        const std::function<bool(const BodyInCell&)>& enough,
                        const std::function<bool()>& stop) {
  return body.dimension == 2 ? body_in<2>(body, edge, excluded, threads, enough, stop)
                             : body_in<3>(body, edge, excluded, threads, enough, stop);
}

template MeasuredBody measured_body<2>(const Config&, const Scene<2>&, double, const std::string&);
template MeasuredBody measured_body<3>(const Config&, const Scene<3>&, double, const std::string&);

}  // namespace odpd
