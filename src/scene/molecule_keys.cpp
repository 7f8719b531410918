// The keys of [[molecule]] and the shapes it knows by name.
#include <fmt/format.h>

#include <cmath>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/particles/rigid_body.h"
#include "odpd/scene/scene_settings.h"

namespace odpd {

namespace {

BondExclusion read_exclusion(const Config& entry) {
  const std::string exclude = entry.choice("exclude", {"none", "repulsion", "all"}, "none");
  if (exclude == "none") return BondExclusion::none;
  return exclude == "repulsion" ? BondExclusion::repulsion : BondExclusion::all;
}

template <int D>
Vec<D> bead_place(const Config& entry) {
  const std::vector<double> values = entry.numbers("at");
  if (values.size() != D)
    entry.fail("at", fmt::format("{} components are needed in {} dimensions, there are {}", D, D,
                                 values.size()));
  Vec<D> v;
  for (std::size_t c = 0; c < D; ++c) v.x[c] = values[c];
  return v;
}

// D + 1 points, each a distance `edge` from all others: a triangle, or a tetrahedron.
template <int D>
std::vector<Vec<D>> simplex(double edge) {
  std::vector<Vec<D>> points(1);
  for (int c = 0; c < D; ++c) {
    Vec<D> next{};
    for (const Vec<D>& p : points) next += (1.0 / static_cast<double>(points.size())) * p;
    const Vec<D> arm = points[0] - next;
    next[c] = std::sqrt(edge * edge - dot(arm, arm));
    points.push_back(next);
  }
  return points;
}

// Six corners (D = 3), each opposite another.
template <int D>
std::vector<Vec<D>> octahedron(double edge) {
  std::vector<Vec<D>> points(2 * D);
  for (int c = 0; c < D; ++c) {
    points[index(2 * c)][c] = edge * std::sqrt(0.5);
    points[index(2 * c + 1)][c] = -edge * std::sqrt(0.5);
  }
  return points;
}

template <int D>
std::vector<Vec<D>> cube(double edge) {
  std::vector<Vec<D>> points(std::size_t{1} << D);
  for (std::size_t k = 0; k < points.size(); ++k)
    for (int c = 0; c < D; ++c) points[k][c] = edge * (static_cast<double>((k >> c) & 1U) - 0.5);
  return points;
}

// Corners, neighbours at `spacing` or all at `radius` from their centre.
template <int D>
std::vector<Vec<D>> corners(const Config& entry, const std::string& shape) {
  const auto of_edge = [&](double edge) {
    if (shape == "simplex") return simplex<D>(edge);
    return shape == "cube" ? cube<D>(edge) : octahedron<D>(edge);
  };
  if (!entry.has("radius")) return of_edge(entry.positive("spacing"));
  if (entry.has("spacing")) entry.fail("radius", "give radius or spacing, never both");
  const std::vector<Vec<D>> unit = of_edge(1.0);
  Vec<D> centre{};
  for (const Vec<D>& p : unit) centre += (1.0 / static_cast<double>(unit.size())) * p;
  return of_edge(entry.positive("radius") / norm(unit[0] - centre));
}

template <int D>
void read_beads(const Config& entry, const std::string& shape, MoleculeSettings<D>& m) {
  if (shape == "points") {
    for (const Config& point : entry.tables("points")) {
      m.shape.push_back(bead_place<D>(point));
      m.species_names.push_back(point.text("species", m.species_names[0]));
    }
    m.species_names.erase(m.species_names.begin());
    if (m.shape.empty())
      entry.fail("points", "a shape of points needs some: points = [{ at = [0.0, ...] }, ...]");
  } else if (shape == "particle") {
    m.shape.emplace_back();
  } else if (shape != "chain" && shape != "walk") {
    m.shape = corners<D>(entry, shape);
  } else {
    const double spacing = entry.positive("spacing");
    const std::int64_t beads = entry.positive_integer("beads", 2);
    for (std::int64_t k = 0; k < beads; ++k) {
      Vec<D> r{};
      r[0] = spacing * static_cast<double>(k);
      m.shape.push_back(r);
    }
    if (shape == "walk") m.walk = spacing;
  }
  if (m.shape.size() > 1 && shape != "points")
    m.species_names.resize(m.shape.size(), m.species_names[0]);
  Vec<D> centre{};
  for (const Vec<D>& r : m.shape) centre += (1.0 / static_cast<double>(m.shape.size())) * r;
  for (Vec<D>& r : m.shape) r -= centre;
}

template <int D>
double span_of(const MoleculeSettings<D>& m, std::int64_t i, std::int64_t j) {
  return norm(m.shape[index(i)] - m.shape[index(j)]);
}

// A table per bond, with the molecule's H, r_0 and r_max where it has none of its own.
template <int D>
void read_listed_bonds(const Config& entry, MoleculeSettings<D>& m) {
  for (const Config& bond : entry.tables("bond")) {
    const std::vector<double> ends = bond.numbers("between");
    const auto beads = static_cast<double>(m.beads());
    const auto is_bead = [&](double x) { return x >= 0.0 && x < beads && x == std::floor(x); };
    if (ends.size() != 2 || !is_bead(ends[0]) || !is_bead(ends[1]) || ends[0] == ends[1])
      bond.fail("between",
                fmt::format("two different beads are needed, counted from 0 to {}", m.beads() - 1));
    const auto i = static_cast<std::int64_t>(ends[0]), j = static_cast<std::int64_t>(ends[1]);
    BondParameters p = read_bond(entry, span_of(m, i, j), true);
    const auto own_or_common = [&](const char* key, double common) {
      if (!bond.has(key) && !entry.has(key))
        bond.fail(key, "is missing: give it here, or in the [[molecule]] for all its bonds");
      return bond.positive(key, common);
    };
    p.H = own_or_common("H", p.H);
    if (p.law == BondLaw::fene) p.r_max = own_or_common("r_max", p.r_max);
    p.r_0 = bond.non_negative("r_0", p.r_0);
    m.bonds.push_back({i, j, p});
  }
}

// Springs to the sites of a rigid frame that has the shape; every pair of beads gets an edge of them.
template <int D>
void read_sites(const Config& entry, MoleculeSettings<D>& m) {
  if (m.walk > 0.0)
    entry.fail(
        "bonds",
        "\"sites\" stand where the shape has its beads, and a walk has no shape: use another");
  for (const char* key : {"law", "r_0", "r_max"})
    if (entry.has(key))
      entry.fail(key,
                 "leave it out: with bonds = \"sites\" a spring has H alone, and no force "
                 "where a bead is on its site");
  if (!turn_under<D>(m.shape, m.shape, Vec<D>{}))
    entry.fail("shape",
               "with bonds = \"sites\" the sites must not lie in one point, nor on a line in 3D: "
               "their frame could turn freely");
  m.site_H = entry.positive("H");
  BondParameters p{.law = BondLaw::sites, .H = m.site_H, .exclude = read_exclusion(entry)};
  for (std::int64_t i = 0; i < m.beads(); ++i)
    for (std::int64_t j = i + 1; j < m.beads(); ++j) {
      p.r_0 = span_of(m, i, j);
      m.bonds.push_back({i, j, p});
    }
}

template <int D>
void read_bonds(const Config& entry, bool chain, MoleculeSettings<D>& m) {
  if (m.beads() < 2) return;
  if (entry.has("bond")) return read_listed_bonds(entry, m);
  const std::string which =
      entry.choice("bonds", {"chain", "all", "sites"}, chain ? "chain" : "all");
  if (which == "sites") return read_sites(entry, m);
  for (std::int64_t i = 0; i < m.beads(); ++i)
    for (std::int64_t j = i + 1; j < m.beads() && (which == "all" || j == i + 1); ++j)
      m.bonds.push_back({i, j, read_bond(entry, span_of(m, i, j))});
}

// Beads that no bond holds would be molecules of their own.
template <int D>
void check_joined(const Config& entry, const MoleculeSettings<D>& m) {
  std::vector<bool> joined(m.shape.size(), false);
  joined[0] = true;
  for (std::int64_t round = 0; round < m.beads(); ++round)
    for (const auto& bond : m.bonds) {
      const auto i = index(bond.i), j = index(bond.j);
      if (joined[i] || joined[j]) joined[i] = joined[j] = true;
    }
  for (std::size_t k = 0; k < joined.size(); ++k)
    if (!joined[k])
      entry.fail("bond",
                 fmt::format("no bonds join beads 0 and {}: add some, or make them molecules "
                             "of their own",
                             k));
}

template <int D>
void check_bonds(const Config& entry, const Box<D>& box, const MoleculeSettings<D>& m) {
  for (const auto& bond : m.bonds) {
    const double length = span_of(m, bond.i, bond.j);
    for (int c = 0; c < D; ++c)
      if (box.is_periodic(c) && length >= 0.5 * box.size[c])
        entry.fail("shape", fmt::format("the bond of beads {} and {} is {:.4g} long: it must be "
                                        "shorter than half the box in direction {}",
                                        bond.i, bond.j, length, "xyz"[c]));
    if (bond.p.law == BondLaw::fene && !std::isfinite(bond_terms(bond.p, length).u))
      entry.fail("r_max", fmt::format("the bond of beads {} and {} is {:.4g} long in the shape, "
                                      "out of its reach: | length - r_0 | must be below r_max = {}",
                                      bond.i, bond.j, length, bond.p.r_max));
  }
}

template <int D>
void read_places(const Config& entry, const Box<D>& box, MoleculeSettings<D>& m) {
  for (const Config& place : entry.tables("positions")) {
    m.positions.push_back(bead_place<D>(place));
    for (const Vec<D>& bead : m.shape)
      for (int c = 0; c < D; ++c) {
        const double x = m.positions.back()[c] + bead[c];
        if (!box.is_periodic(c) && !(x >= 0.0 && x <= box.size[c]))
          place.fail("at",
                     fmt::format("a bead would lie at {} = {}, outside the box", "xyz"[c], x));
      }
  }
  if (!m.positions.empty() && entry.has("count"))
    entry.fail("count", "give positions or count, never both");
  if (m.positions.empty()) m.count = entry.positive_integer("count", 1);
  if (!m.positions.empty() && entry.has("clearance"))
    entry.fail("clearance", "it is kept by random places, and positions are given");
  m.clearance = entry.non_negative("clearance", 0.0);
  if (m.clearance > 0.0 && m.walk > 0.0)
    entry.fail("clearance", "a random walk lies anywhere: leave it out, or use another shape");
  if (!m.positions.empty() && m.walk > 0.0)
    entry.fail("positions", "a random walk lies anywhere: give count, or shape = \"chain\"");
}

template <int D>
void read_bonds_file(const Config& config, SceneSettings<D>& scene) {
  const Config bonds = config.table("bonds");
  if (!bonds.has("file")) return;
  if (scene.start != StartKind::file)
    bonds.fail(
        "file",
        "it names particles by their place in the start file: give start.from = \"file\", or "
        "use [[molecule]]");
  scene.bonds_file = bonds.file("file").string();
  scene.file_bond = read_bond(bonds, 0.0, true);
}

}  // namespace

BondParameters read_bond(const Config& entry, double length, bool open) {
  BondParameters p;
  const bool fene = entry.choice("law", {"harmonic", "fene"}, "harmonic") == "fene";
  p.law = fene ? BondLaw::fene : BondLaw::harmonic;
  if (!open || entry.has("H")) p.H = entry.positive("H");
  // The default differs from bond to bond: it is not one of the case.
  p.r_0 = entry.has("r_0") ? entry.non_negative("r_0") : fene ? 0.0 : length;
  if (fene && (!open || entry.has("r_max"))) p.r_max = entry.positive("r_max");
  p.exclude = read_exclusion(entry);
  return p;
}

template <int D>
MoleculeSettings<D> read_molecule(const Config& entry, const Box<D>& box) {
  MoleculeSettings<D> m;
  m.name = entry.text("name", m.name);
  if (!is_plain_name(m.name))
    entry.fail("name", "use letters, digits, _ and -: it goes into file columns");
  std::vector<std::string> shapes{"chain", "walk", "simplex", "points", "particle"};
  if (D > 2) shapes.insert(shapes.end(), {"octahedron", "cube"});
  const std::string shape = entry.choice("shape", shapes);
  m.species_names = {entry.text("species")};
  read_beads(entry, shape, m);
  read_bonds(entry, shape == "chain" || shape == "walk", m);
  check_joined(entry, m);
  check_bonds(entry, box, m);
  read_places(entry, box, m);
  return m;
}

template <int D>
void read_molecules(const Config& config, SceneSettings<D>& scene) {
  for (const Config& entry : config.tables("molecule")) {
    MoleculeSettings<D> molecule = read_molecule<D>(entry, scene.box);
    read_molecule_sizes(entry, scene, molecule);
    scene.molecules.push_back(std::move(molecule));
    auto& m = scene.molecules.back();
    for (std::size_t k = 0; k + 1 < scene.molecules.size(); ++k)
      if (scene.molecules[k].name == m.name)
        entry.fail("name", fmt::format("two kinds of molecules are named '{}'", m.name));
    for (const std::string& name : m.species_names)
      m.species.push_back(species_index(scene.species, entry, "species", name));
  }
  read_bonds_file(config, scene);
}

template void read_molecules<2>(const Config&, SceneSettings<2>&);
template void read_molecules<3>(const Config&, SceneSettings<3>&);
template struct MoleculeSettings<2>;
template struct MoleculeSettings<3>;
template MoleculeSettings<2> read_molecule<2>(const Config&, const Box<2>&);
template MoleculeSettings<3> read_molecule<3>(const Config&, const Box<3>&);

}  // namespace odpd
