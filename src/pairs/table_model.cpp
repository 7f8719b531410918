#include "odpd/pairs/table_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "odpd/core/error.h"

namespace odpd {

namespace {

constexpr double gap = 2.5;        // times as wide as both its neighbours: rows are missing
constexpr double rounding = 1e-9;  // of the cutoff, to which a table reaches

[[noreturn]] void refuse_row(const TextTable& csv, std::size_t row, const std::string& why) {
  throw ConfigError(fmt::format("{}:{}: {}", csv.file, csv.line[row], why));
}

ForceTable::Values values_of(const TextTable& csv) {
  const bool force = csv.find("f").has_value(), energy = csv.find("u").has_value();
  if (force && energy)
    throw ConfigError(fmt::format(
        "{}: it has a column f and a column u, of which one follows from the other: keep one (f "
        "is more accurate) and rename or remove the other",
        csv.file));
  return energy ? ForceTable::Values::energy : ForceTable::Values::force;
}

std::vector<double> distances(const TextTable& csv) {
  const std::size_t column = csv.column("r", "a table of force needs r, and f or u");
  std::vector<double> r;
  for (std::size_t row = 0; row < csv.rows.size(); ++row) {
    r.push_back(csv_number(csv, row, column));
    if (r[row] < 0.0)
      refuse_row(csv, row, fmt::format("r = {} is no distance: it must be >= 0", r[row]));
    if (row > 0 && r[row] <= r[row - 1])
      refuse_row(csv, row,
                 fmt::format("r = {} comes after r = {}: sort the rows by ascending r, each once",
                             r[row], r[row - 1]));
  }
  if (r.size() < 2)
    throw ConfigError(
        fmt::format("{}: it has {} row(s): a table of force needs two or more, up to the cutoff",
                    csv.file, r.size()));
  for (std::size_t row = 2; row + 1 < r.size(); ++row) {
    const double width = r[row] - r[row - 1];
    if (width > gap * std::max(r[row - 1] - r[row - 2], r[row + 1] - r[row]))
      refuse_row(csv, row,
                 fmt::format("rows are missing between r = {} and r = {}, which are more than {} "
                             "times as far apart as the rows before and after them: add them",
                             r[row - 1], r[row], gap));
  }
  return r;
}

std::vector<double> values(const TextTable& csv) {
  const bool energy = values_of(csv) == ForceTable::Values::energy;
  const std::size_t column = csv.column(energy ? "u" : "f", "a table of force needs r, and f or u");
  std::vector<double> values;
  for (std::size_t row = 0; row < csv.rows.size(); ++row)
    values.push_back(csv_number(csv, row, column));
  return values;
}

void validate(const TableParameters& p) {
  if (p.force == nullptr) throw ConfigError("model \"table\": a pair of species has no table");
  validate(p.friction);
  const double cutoff = p.friction.cutoff, begin = p.force->points().front(),
               end = p.force->points().back();
  if (end < cutoff * (1.0 - rounding))
    throw ConfigError(fmt::format(
        "{}: the table ends at r = {}, before the cutoff {}: add rows up to it (with f = 0, or u "
        "as before, where the force ends sooner), or set the key cutoff to {}",
        p.force->end(), end, cutoff, end));
  if (begin >= cutoff)
    throw ConfigError(
        fmt::format("{}: the table begins at r = {}, not before the cutoff {}: enlarge the key "
                    "cutoff, or add rows",
                    p.force->file(), begin, cutoff));
}

// Keys of [fluid] (`whole`) or one pair of species, `base` where they are absent.
TableParameters read_parameters(const Config& keys, const TableParameters& base, bool whole) {
  TableParameters p = base;
  if (whole || keys.has("force_file")) {
    const std::string text =
        keys.file_text("force_file", "name a CSV with columns r and f, or r and u");
    p.force = std::make_shared<const ForceTable>(parse_csv(text, keys.file("force_file").string()));
  }
  const std::string below =
      keys.choice("force_below", {"error", "constant"}, base.constant_below ? "constant" : "error");
  p.constant_below = below == "constant";
  p.friction = read_friction(keys, base.friction, whole);
  return p;
}

}  // namespace

namespace {

MonotoneSpline spline_of(const std::string& file, std::vector<double> r,
                         const std::vector<double>& value) {
  try {
    return {std::move(r), value};
  } catch (const ConfigError& e) {
    throw ConfigError(fmt::format("{}: {}", file, e.what()));
  }
}

}  // namespace

ForceTable::ForceTable(std::string file, Values values, std::vector<double> r,
                       const std::vector<double>& value)
    : file_(std::move(file)),
      end_(file_),
      values_(values),
      spline_(spline_of(file_, std::move(r), value)) {
  if (points().front() < 0.0) throw ConfigError(fmt::format("{}: a distance must be >= 0", file_));
}

ForceTable::ForceTable(const TextTable& csv)
    : ForceTable(csv.file, values_of(csv), distances(csv), values(csv)) {
  end_ = fmt::format("{}:{}", csv.file, csv.line.back());
}

void ForceTable::operator()(double r, PairTerms& t) const {
  const MonotoneSpline::Value s = spline_(r);
  const bool energy = values_ == Values::energy;
  t.u = energy ? s.y : s.rest;
  t.f_c = energy ? -s.first : s.y;
  t.k_c = energy ? s.second : -s.first;
}

template <int D>
TableModel<D>::TableModel(int species, const std::vector<TableParameters>& parameters)
    : species_(species) {
  require_pair_table(species, parameters);
  for (const TableParameters& p : parameters) {
    validate(p);
    const std::vector<double>& points = p.force->points();
    Entry entry{p, Friction(p.friction), points.front(), {}, {}};
    (*p.force)(entry.begin, entry.first);
    (*p.force)(p.friction.cutoff, entry.last);
    for (const double r : points) {
      PairTerms t;
      (*p.force)(r, t);
      const bool inside = r < p.friction.cutoff;
      conservative_ = conservative_ || (inside && (t.f_c != 0.0 || t.u != entry.last.u));
    }
    cutoff_ = std::max(cutoff_, p.friction.reach());
    thermal_ = thermal_ || p.friction.kT > 0.0;
    may_refuse_ = may_refuse_ || (entry.begin > 0.0 && !p.constant_below);
    table_.push_back(std::move(entry));
  }
}

template <int D>
PairTerms TableModel<D>::terms(double r, Site site_i, Site site_j) const {
  const Entry& of = entry(site_i, site_j);
  PairTerms t;
  of.friction(r, t);
  if (r >= of.p.friction.cutoff) return t;
  if (r >= of.begin) {
    (*of.p.force)(r, t);
    t.u -= of.last.u;
    return t;
  }
  t.f_c = of.first.f_c;
  t.u = of.p.constant_below ? of.first.u - of.last.u + t.f_c * (of.begin - r)
                            : std::numeric_limits<double>::infinity();
  return t;
}

template <int D>
std::vector<double> TableModel<D>::kinks(Site site_i, Site site_j) const {
  const TableParameters& p = entry(site_i, site_j).p;
  std::vector<double> kinks = p.friction.kinks();
  for (const double r : p.force->points())
    if (r > 0.0 && r < p.friction.cutoff) kinks.push_back(r);
  std::sort(kinks.begin(), kinks.end());
  return kinks;
}

template <int D>
void TableModel<D>::refuse_unknown(const PairNetwork<D>& network,
                                   const Particles<D>& particles) const {
  for (std::size_t k = 0; may_refuse_ && k < index(network.pairs()); ++k) {
    if (network.u[k] < std::numeric_limits<double>::infinity()) continue;
    const std::size_t i = index(network.i[k]), j = index(network.j[k]);
    const Entry& of = entry(site_of(particles, i), site_of(particles, j));
    const double high = of.first.u - of.last.u;
    throw BlowUpError(
        fmt::format(
            "particles {} and {} are {:.4g} apart, and {} begins at r = {}: begin it "
            "nearer, set the key force_below to \"constant\", or {}",
            particles.id[i], particles.id[j], network.r[k], of.p.force->file(), of.begin,
            high > 10.0 * of.p.friction.kT
                ? "keep them apart by a smaller integrator.dt or another start"
                : fmt::format("raise its core: u is only {:.3g} there, so pairs come nearer "
                              "at any integrator.dt",
                              high)),
        particles.id[i]);
  }
}

template <int D>
ModelParameters TableModel<D>::parameters() const {
  const TableParameters& p = table_[0].p;
  return {"table",
          {{"rows", static_cast<double>(p.force->points().size())},
           {"first_r", p.force->points().front()},
           {"gamma", p.friction.gamma},
           {"sigma", std::sqrt(2.0 * p.friction.gamma * p.friction.kT)},
           {"s", p.friction.s}}};
}

template <int D>
std::shared_ptr<const PairModel<D>> read_table_model(const FluidKeys& keys) {
  const auto fluid = read_parameters(keys.fluid, TableParameters{}, true);
  const auto table = pair_table(keys, fluid, [](const Config& pair, const TableParameters& base) {
    return read_parameters(pair, base, false);
  });
  return std::make_shared<const TableModel<D>>(static_cast<int>(keys.species), table);
}

template class TableModel<2>;
template class TableModel<3>;
template std::shared_ptr<const PairModel<2>> read_table_model<2>(const FluidKeys&);
template std::shared_ptr<const PairModel<3>> read_table_model<3>(const FluidKeys&);

}  // namespace odpd
