#include "odpd/app/case.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>

#include "odpd/app/calibration_file.h"
#include "odpd/app/restart.h"
#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/io/csv.h"
#include "odpd/io/trajectory.h"

namespace odpd {

namespace {

std::int64_t steps_of(const Config& run, const std::string& key, double time, double dt) {
  const double steps = time / dt;
  if (steps > 1e15)
    run.fail(key, "that is more than 1e15 steps: shorten it or enlarge integrator.dt");
  return std::llround(steps);
}

SolverOptions read_solver(const Config& config, bool& hold_centre_of_mass) {
  SolverOptions options;
  options.name = config.choice("name", solver_names(), options.name);
  const SolverTraits& traits = solver_traits(options.name);
  options.tolerance = config.positive("tolerance", options.tolerance);
  if (options.tolerance >= 1.0) config.fail("tolerance", "must be below 1");
  options.max_iterations = config.positive_integer("max_iterations", options.max_iterations);
  options.stopping = config.choice("stopping", {"residual", "increment"}, "residual") == "increment"
                         ? Stopping::increment
                         : Stopping::residual;
  options.petsc_options = config.text("petsc_options", "");
  options.preconditioner = config.choice("preconditioner", preconditioner_names(), "auto");
  if (options.preconditioner != "auto" && !traits.preconditioned)
    config.fail("preconditioner",
                "only solver.name = \"pcg\" has a choice of preconditioners: "
                "leave this key out");
  hold_centre_of_mass = config.boolean("hold_centre_of_mass", traits.holds_centre_of_mass);
  if (traits.holds_centre_of_mass && !hold_centre_of_mass)
    config.fail("hold_centre_of_mass",
                "picard-deflated (Scheme 2) holds the centre of mass still by construction: leave "
                "this key out, or choose another solver");
  return options;
}

std::int64_t interval(const Config& config, const std::string& key, std::int64_t fallback) {
  const std::int64_t steps = config.integer(key, fallback);
  if (steps < 0) config.fail(key, "must be a number of steps, or 0 for never");
  return steps;
}

std::vector<CheckSettings> read_checks(const Config& config) {
  std::vector<CheckSettings> checks;
  for (const Config& entry : config.tables("check")) {
    CheckSettings check;
    check.observable = entry.text("observable");
    check.name = entry.text("name", check.observable);
    check.source = entry.text("source", "");
    const bool band = entry.has("minimum") || entry.has("maximum");
    if (band) {
      // A band is a value with a tolerance around it.
      const double low = entry.number("minimum");
      const double high = entry.number("maximum");
      if (!(low < high)) entry.fail("minimum", "must be less than maximum");
      check.expected = 0.5 * (low + high);
      check.tolerance = 0.5 * (high - low);
    } else {
      check.expected = entry.number("expected");
      if (entry.has("tolerance") == entry.has("relative_tolerance"))
        entry.fail("expected", "needs tolerance or relative_tolerance, one of them");
      check.tolerance = entry.has("tolerance")
                            ? entry.non_negative("tolerance")
                            : entry.positive("relative_tolerance") * std::abs(check.expected);
    }
    if (entry.has("standard_error_below"))
      check.standard_error_below = entry.positive("standard_error_below");
    checks.push_back(std::move(check));
  }
  return checks;
}

// What the numbers of species in a start file count from: 0 or 1 cannot be told apart unless 0 is among them.
template <int D>
std::int64_t first_number(const SceneSettings<D>& scene, const std::set<std::int64_t>& numbers) {
  if (scene.first_species) return *scene.first_species;
  if (numbers.empty() || numbers.contains(0)) return 0;
  if (scene.species.size() == 1 && numbers.size() == 1) return *numbers.begin();
  throw ConfigError(fmt::format(
      "{}: its species are numbers from {} on, none of them 0, so they may count from 1, as "
      "LAMMPS' types do, or from 0: add start.first_species = 1 (then 1 is '{}') or = 0",
      scene.start_file, *numbers.begin(), scene.species[0].name));
}

// A particle's species in a start file, and its line where that is text.
struct SpeciesWord {
  std::string word;
  std::int64_t line = 0;
};

// By their names or, for other words, as numbers.
template <int D>
void find_species(SceneSettings<D>& scene, const std::vector<SpeciesWord>& words) {
  const auto named = [&](const std::string& word) {
    return std::find_if(scene.species.begin(), scene.species.end(),
                        [&](const SpeciesSettings& s) { return s.name == word; }) -
           scene.species.begin();
  };
  const auto count = static_cast<std::int64_t>(scene.species.size());
  const auto number = [](const std::string& word) {
    std::int64_t value = -1;
    const auto end = std::from_chars(word.data(), word.data() + word.size(), value).ptr;
    return end == word.data() + word.size() ? value : -1;
  };
  std::set<std::int64_t> numbers;
  for (const SpeciesWord& s : words)
    if (named(s.word) == count && number(s.word) >= 0) numbers.insert(number(s.word));
  const std::int64_t first = first_number(scene, numbers);
  for (const SpeciesWord& s : words) {
    std::int64_t number_of = named(s.word);
    if (number_of == count && number(s.word) >= 0) number_of = number(s.word) - first;
    if (number_of < 0 || number_of >= count)
      throw ConfigError(fmt::format(
          "{}{}: species '{}' is not one of the case's [[species]]{}; add it there",
          scene.start_file, s.line > 0 ? fmt::format(":{}", s.line) : "", s.word,
          number(s.word) < 0 ? ""
                             : fmt::format(" (numbered from {}, start.first_species)", first)));
    scene.start_species.push_back(static_cast<std::int32_t>(number_of));
  }
}

template <int D>
void read_start_csv(SceneSettings<D>& scene) {
  const TextTable table = read_csv(scene.start_file);
  const std::string needs =
      fmt::format("a start file needs {} and, if wanted, species", D > 2 ? "x, y, z" : "x, y");
  std::array<std::size_t, D> columns{};
  for (std::size_t c = 0; c < D; ++c) columns[c] = table.column(std::string(1, "xyz"[c]), needs);
  const auto species = table.find("species");
  std::vector<SpeciesWord> words;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    Vec<D> r;
    for (std::size_t c = 0; c < D; ++c) r.x[c] = csv_number(table, row, columns[c]);
    scene.start_positions.push_back(r);
    if (species) words.push_back({table.rows[row][*species], table.line[row]});
  }
  find_species(scene, words);
}

// Columns i and j (particles of the start file, from 0), and if wanted H, r_0 and r_max.
template <int D>
void read_bonds_csv(const Config& config, SceneSettings<D>& scene) {
  const TextTable table = parse_csv(config.table("bonds").file_text("file"), scene.bonds_file);
  const std::string needs = "a file of bonds needs i and j and, if wanted, H, r_0, r_max";
  const std::array<std::size_t, 2> ends{table.column("i", needs), table.column("j", needs)};
  const auto particles = static_cast<double>(scene.start_positions.size());
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const auto number = [&](const char* name, double otherwise) {
      const auto column = table.find(name);
      return column ? csv_number(table, row, *column) : otherwise;
    };
    const auto particle = [&](std::size_t column) {
      const double x = csv_number(table, row, column);
      if (!(x >= 0.0 && x < particles && x == std::floor(x)))
        throw ConfigError(
            fmt::format("{}:{}: {} = {} is no particle of the start file, which are "
                        "counted from 0 to {}",
                        table.file, table.line[row], table.columns[column], x, particles - 1.0));
      return static_cast<std::int64_t>(x);
    };
    Bond bond{particle(ends[0]), particle(ends[1]), scene.file_bond};
    bond.p.H = number("H", bond.p.H);
    bond.p.r_0 = number("r_0", bond.p.r_0);
    bond.p.r_max = number("r_max", bond.p.r_max);
    const auto positive = [&](const char* name, double value) {
      if (!(value > 0.0))
        throw ConfigError(fmt::format(
            "{}:{}: the bond of particles {} and {} has {} = {}, which must be positive: give it "
            "in a column {}, or for all bonds as bonds.{}",
            table.file, table.line[row], bond.i, bond.j, name, value, name, name));
    };
    positive("H", bond.p.H);
    if (bond.p.law == BondLaw::fene) positive("r_max", bond.p.r_max);
    scene.start_bonds.push_back(bond);
  }
}

// Other programs may round the edges to single precision.
template <int D>
void check_box(const Frame& frame, const Box<D>& box, const std::string& file) {
  for (std::size_t c = 0; c < frame.box_size.size(); ++c)
    if (std::abs(frame.box_size[c] - box.size.x[c]) > 1e-6 * box.size.x[c])
      throw ConfigError(fmt::format(
          "{}: its box is {} long in direction {}, the case's is {}: set box.size to {}", file,
          frame.box_size[c], "xyz"[c], box.size.x[c], fmt::join(frame.box_size, ", ")));
}

// The offset of the images in a tilted cell, as sheared runs write it.
template <int D>
void take_offset(const Frame& frame, Box<D>& box, const std::string& file) {
  if (frame.edges.empty()) return;
  for (int row = 0; row < D; ++row)
    for (int c = 0; c < D; ++c) {
      const double value = frame.edges[index(row * D + c)];
      if (row == c || value == 0.0) continue;
      if (!box.shear || box.shear->gradient != row || box.shear->flow != c)
        throw ConfigError(fmt::format(
            "{}: its box is tilted, as sheared runs leave it: the images along {} are displaced by "
            "{} along {}; start from it with [shear] flow = \"{}\", gradient = \"{}\"",
            file, "xyz"[row], value, "xyz"[c], "xyz"[c], "xyz"[row]));
      box.shear->start = value;
    }
  box = box.at(0.0);
}

template <int D>
void read_start_h5md(SceneSettings<D>& scene) {
  const Frame frame = read_h5md(scene.start_file);
  if (frame.dimension != D)
    throw ConfigError(
        fmt::format("{} holds positions in {} dimensions, the case has dimension = {}",
                    scene.start_file, frame.dimension, D));
  check_box(frame, scene.box, scene.start_file);
  take_offset(frame, scene.box, scene.start_file);
  const std::size_t n = frame.position.size() / D;
  std::vector<SpeciesWord> words;
  for (std::size_t k = 0; k < n; ++k) {
    // The walls of an odpd trajectory are placed by the case itself.
    const auto group = Group::of_code(k < frame.group.size() ? frame.group[k] : 0);
    const auto walls = static_cast<std::int32_t>(scene.walls.size());
    if (group.is_known() && group.body(walls) < 0) continue;
    if (group.is_known() && scene.bodies.empty())
      throw ConfigError(
          fmt::format("{}: particle {} is of known velocity, of a wall or body that the case does "
                      "not have: start "
                      "from it with the [[wall]] and [[body]] entries of the run that wrote it",
                      scene.start_file, k));
    Vec<D> r;
    for (std::size_t c = 0; c < D; ++c) r.x[c] = frame.position[k * D + c];
    if (!group.is_free()) {
      const auto body = index(group.body(walls));
      if (body >= n)
        throw ConfigError(fmt::format("{}: it has no body {}", scene.start_file, body));
      scene.start_bodies.resize(std::max(scene.start_bodies.size(), body + 1));
      scene.start_bodies[body].push_back(r);
      continue;
    }
    scene.start_positions.push_back(r);
    if (k >= frame.species.size()) continue;
    const auto species = index(frame.species[k]);
    words.push_back({species < frame.species_names.size() ? frame.species_names[species]
                                                          : std::to_string(frame.species[k])});
  }
  find_species(scene, words);
}

}  // namespace

Config open_case(const std::filesystem::path& path, const std::vector<std::string>& overrides) {
  return Config::from_file(path, overrides);
}

std::string case_name(const std::filesystem::path& path) {
  std::filesystem::path full = std::filesystem::absolute(path).lexically_normal();
  if (!full.has_filename()) full = full.parent_path();
  if (full.filename() == "case.toml") full = full.parent_path();
  return full.extension() == ".toml" ? full.stem().string() : full.filename().string();
}

CaseSettings read_case(const Config& config, const std::string& name) {
  CaseSettings c;
  c.name = name;
  c.title = config.text("title", name);
  const std::int64_t dimension = config.integer("dimension");
  if (dimension != 2 && dimension != 3) config.fail("dimension", "must be 2 or 3");
  c.dimension = static_cast<int>(dimension);
  c.dynamics.seed = static_cast<std::uint64_t>(config.integer("seed", 1));
  const Config integrator = config.table("integrator");
  c.integrator = read_integrator(integrator);
  // Sweeps of Monte Carlo are counted.
  c.clock.dt = integrator_traits(c.integrator.name).in_time ? integrator.positive("dt")
                                                            : integrator.positive("dt", 1.0);
  c.solver = read_solver(config.table("solver"), c.dynamics.hold_centre_of_mass);
  const Config neighbours = config.table("neighbours");
  if (neighbours.has("skin")) c.dynamics.skin = neighbours.non_negative("skin");
  c.dynamics.reorder_every = interval(neighbours, "reorder_every", c.dynamics.reorder_every);
  const Config run = config.table("run");
  c.clock.equilibration_steps =
      steps_of(run, "equilibrate", run.non_negative("equilibrate", 0.0), c.clock.dt);
  const std::int64_t measured = steps_of(run, "duration", run.positive("duration"), c.clock.dt);
  if (measured < 1) run.fail("duration", "is shorter than one time step (integrator.dt)");
  c.clock.total_steps = c.clock.equilibration_steps + measured;
  c.blow_up = run.positive("blow_up", c.blow_up);
  if (!(c.blow_up > 1.0))
    run.fail("blow_up", "is a multiple of what a sound run may reach: it must be above 1");
  if (run.has("until")) {
    const Config until = run.table("until");
    c.until = TargetSettings{until.text("observable"), until.positive("standard_error")};
  }
  const Config output = config.table("output");
  c.output.checkpoint_every = interval(output, "checkpoint_every", c.output.checkpoint_every);
  c.output.trajectory_every = interval(output, "trajectory_every", c.output.trajectory_every);
  c.output.vtk_every = interval(output, "vtk_every", c.output.vtk_every);
  c.output.pictures = output.boolean("pictures", c.output.pictures);
  c.checks = read_checks(config);
  return c;
}

namespace {

template <int D>
void read_start_file(SceneSettings<D>& scene) {
  if (scene.start != StartKind::file) return;
  const std::string extension = std::filesystem::path(scene.start_file).extension().string();
  if (extension == ".csv") {
    read_start_csv(scene);
  } else if (extension == ".h5" || extension == ".h5md" || extension == ".hdf5") {
    read_start_h5md(scene);
  } else {
    throw ConfigError(
        fmt::format("{}: start files are CSV (.csv) or H5MD (.h5, .h5md)", scene.start_file));
  }
  if (scene.start_positions.empty())
    throw ConfigError(fmt::format("{}: there are no fluid particles in it", scene.start_file));
}

}  // namespace

template <int D>
SceneSettings<D> read_scene(const Config& config, CheckpointReader* restart) {
  SceneSettings<D> scene = read_scene_settings<D>(config, read_calibration(config));
  if (restart) {
    take_start(*restart, scene);
  } else {
    read_start_file(scene);
  }
  if (!scene.bonds_file.empty()) read_bonds_csv(config, scene);
  return scene;
}

std::string portable_case(const Config& config) {
  std::vector<std::string> absolute;
  for (const auto& [key, file] : config.files()) {
    std::string quoted;
    for (const char letter : std::filesystem::absolute(file).lexically_normal().string()) {
      if (letter == '"' || letter == '\\') quoted += '\\';
      quoted += letter;
    }
    absolute.push_back(fmt::format("{}=\"{}\"", key, quoted));
  }
  if (absolute.empty()) return config.resolved();
  return Config::from_text(config.resolved(), "case.toml", absolute).resolved();
}

template SceneSettings<2> read_scene<2>(const Config&, CheckpointReader*);
template SceneSettings<3> read_scene<3>(const Config&, CheckpointReader*);

}  // namespace odpd
