#include "odpd/analysis/molecules.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "odpd/core/index.h"

namespace odpd {

namespace {

constexpr std::size_t shape_columns = 4;

template <int D>
std::vector<std::string> names_of_molecules(const Scene<D>& scene) {
  std::vector<std::string> names;
  for (const auto& m : scene.settings().molecules) names.push_back(m.name);
  return names;
}

template <int D>
std::vector<std::size_t> kinds_of_molecules(const Scene<D>& scene) {
  std::vector<std::size_t> kinds;
  for (const Molecule& m : scene.molecules()) kinds.push_back(m.kind);
  return kinds;
}

}  // namespace

template <int D>
MoleculeStatistics<D>::MoleculeStatistics(ObserverSettings settings, MoleculesSettings molecules,
                                          const Scene<D>& scene, double dt, bool in_time)
    : Observer<D>(std::move(settings), shape_columns * scene.settings().molecules.size()),
      msd_(std::move(molecules.msd)),
      scene_(scene),
      in_time_(in_time),
      beads_(scene),
      population_(scene.settings().molecules.size(), 0.0),
      around_(molecules.around, names_of_molecules(scene), kinds_of_molecules(scene)),
      displacements_(this->settings().name, msd_.window, msd_.fit_from,
                     dt * static_cast<double>(this->settings().every), population_.size()) {
  if (in_time_) scene.particles().carry(column());
  for (const Molecule& m : scene.molecules()) population_[m.kind] += 1.0;
  const Particles<D>& particles = scene.particles();
  for (std::size_t i = 0; i < particles.position.size(); ++i)
    if (is_solvent(particles, i)) ++solvent_;
}

template <int D>
std::unique_ptr<Observer<D>> MoleculeStatistics<D>::make(const ObserverEntry<D>& entry) {
  ObserverSettings settings = entry.settings(msd_interval(entry.clock));
  if (entry.scene.settings().molecules.empty())
    entry.config.fail("kind", "the scene has no [[molecule]]");
  const auto beads = entry.scene.settings().molecule_beads();
  for (const char* key : {"r_max", "bin", "empty"})
    if (entry.config.has(key) && entry.scene.particles().free_count() <= beads)
      entry.config.fail(key, "is of the solvent around molecules, and this melt has none");
  MoleculesSettings m{.msd = read_msd(entry), .around = read_fluid_around(entry)};
  return std::make_unique<MoleculeStatistics<D>>(std::move(settings), std::move(m), entry.scene,
                                                 entry.clock.dt, entry.in_time);
}

template <int D>
void MoleculeStatistics<D>::measure(const Clock&, const Particles<D>& particles,
                                    const StepRecord<D>& record) {
  this->add(shapes(particles, record.start));
  if (in_time_) follow(particles);
  if (solvent_ > 0) count_solvent(particles, record.start);
}

// Beads have the last identities of all.
template <int D>
bool MoleculeStatistics<D>::is_solvent(const Particles<D>& particles, std::size_t i) const {
  return particles.is_free(i) && particles.id[i] < scene_.molecules()[0].first;
}

template <int D>
void MoleculeStatistics<D>::count_solvent(const Particles<D>& particles, const Stage<D>& stage) {
  const std::vector<std::int32_t> index_of = particles.index_of_id();
  const Share own = particles.owned();
  std::vector<std::int32_t> solvent;
  for (auto i = index(own.first); i < index(own.end(particles.size())); ++i)
    if (is_solvent(particles, i)) solvent.push_back(static_cast<std::int32_t>(i));
  std::vector<Vec<D>> centres;
  for (const Molecule& m : scene_.molecules()) {
    const std::vector<Vec<D>> beads = beads_.of(m, stage, index_of);
    centres.push_back(stage.position[index(index_of[index(m.first)])]);
    for (const Vec<D>& r : beads) centres.back() += (1.0 / static_cast<double>(beads.size())) * r;
  }
  around_.add(stage, centres, solvent, scene_.fluid_volume() / static_cast<double>(solvent_),
              *own.ranks);
}

template <int D>
std::vector<double> MoleculeStatistics<D>::shapes(const Particles<D>& particles,
                                                  const Stage<D>& stage) const {
  const std::vector<std::int32_t> index_of = particles.index_of_id();
  const Share own = particles.owned();
  std::vector<double> sums(shape_columns * population_.size(), 0.0);
  for (const Molecule& m : scene_.molecules()) {
    const auto& settings = scene_.settings().molecules[m.kind];
    const auto first = index(m.first);
    const auto bead_at = [&](std::size_t bead) {
      return stage.position[index(index_of[first + bead])];
    };
    if (!own.owns(std::int64_t{index_of[first]})) continue;
    double* sum = &sums[shape_columns * m.kind];
    for (const auto& link : settings.bonds) {
      const double r = norm(stage.box.separation(bead_at(index(link.i)), bead_at(index(link.j))));
      const double share = 1.0 / (population_[m.kind] * static_cast<double>(settings.bonds.size()));
      sum[0] += share * r;
      sum[1] += share * r * r;
    }
    const std::vector<Vec<D>> beads = beads_.of(m, stage, index_of);
    const double bead = 1.0 / static_cast<double>(beads.size());
    Vec<D> centre{};
    for (const Vec<D>& r : beads) centre += bead * r;
    for (const Vec<D>& r : beads)
      sum[2] += bead / population_[m.kind] * dot(r - centre, r - centre);
    if (settings.site_H > 0.0)
      sum[3] += bead / population_[m.kind] *
                BalancedFrame<D>({.sites = settings.shape}, beads).distance_squared();
  }
  own.ranks->sum(std::span(sums));
  return sums;
}

// What counts is how far a centre went: whether its beads lie in the same image does not matter.
template <int D>
void MoleculeStatistics<D>::follow(const Particles<D>& particles) {
  std::vector<Vec<D>>& origin = particles.carry(column());
  const std::vector<std::int32_t> index_of = particles.index_of_id();
  const auto unwrapped = [&](std::size_t i, std::size_t c) {
    return particles.position[i].x[c] + particles.image[i][c] * scene_.box().size.x[c];
  };
  const Share own = particles.owned();
  const std::size_t kinds = population_.size();
  std::vector<double> sums(2 * kinds, 0.0);  // of the squares, and how many
  for (const Molecule& m : scene_.molecules()) {
    const auto first = index(m.first);
    if (!displacements_.begun() || !own.owns(std::int64_t{index_of[first]})) continue;
    const auto n = scene_.settings().molecules[m.kind].shape.size();
    sums[kinds + m.kind] += 1.0;
    for (const int direction : msd_.directions) {
      const auto c = index(direction);
      double now = 0.0, before = 0.0;
      for (std::size_t k = 0; k < n; ++k) {
        const auto i = index(index_of[first + k]);
        now += unwrapped(i, c);
        before += origin[i].x[c];
      }
      const double path = now / static_cast<double>(n) - before / static_cast<double>(n);
      sums[m.kind] += path * path;
    }
  }
  own.ranks->sum(std::span(sums));
  const std::span<const double> all(sums);
  if (!displacements_.add_sums(all.first(kinds), all.last(kinds), msd_.directions.size())) return;
  for (std::size_t i = 0; i < origin.size(); ++i)
    for (std::size_t c = 0; c < D; ++c) origin[i].x[c] = unwrapped(i, c);
}

template <int D>
std::vector<std::string> MoleculeStatistics<D>::series_columns() const {
  std::vector<std::string> columns;
  for (const auto& m : scene_.settings().molecules) {
    for (const char* what : {"bond_length", "bond_length_squared", "radius_of_gyration_squared"})
      columns.push_back(fmt::format("{}_{}", what, m.name));
    if (m.site_H > 0.0) columns.push_back(fmt::format("site_distance_squared_{}", m.name));
  }
  return columns;
}

template <int D>
std::vector<double> MoleculeStatistics<D>::series_row() const {
  std::vector<double> row;
  const std::vector<double>& newest = this->newest();
  for (std::size_t k = 0; k < newest.size(); ++k)
    if (k % shape_columns < 3 || scene_.settings().molecules[k / shape_columns].site_H > 0.0)
      row.push_back(newest[k]);
  return row;
}

template <int D>
void MoleculeStatistics<D>::add_results(Results& results) const {
  const BlockAverage& shape = this->average();
  std::vector<double> means;
  for (std::size_t k = 0; k < shape.width(); ++k) means.push_back(shape.mean(k));
  for (std::size_t kind = 0; kind < population_.size(); ++kind) {
    const auto& m = scene_.settings().molecules[kind];
    const std::string prefix = this->settings().name + "." + m.name + ".";
    const std::size_t at = shape_columns * kind;
    const auto variance = [at](const std::vector<double>& mean) {
      return mean[at + 1] - mean[at] * mean[at];
    };
    if (!m.bonds.empty()) {
      results.scalars.push_back(this->mean_of(at, prefix + "bond_length"));
      results.scalars.push_back(
          {prefix + "bond_variance", variance(means), shape.jackknife_error(variance)});
    }
    results.scalars.push_back(this->mean_of(at + 2, prefix + "radius_of_gyration_squared"));
    if (m.site_H > 0.0)
      results.scalars.push_back(this->mean_of(at + 3, prefix + "site_distance_squared"));
    if (solvent_ > 0)
      results.scalars.push_back(
          without_error(prefix + "exclusion_radius", around_.exclusion_radius(kind)));
    if (!in_time_) continue;
    const BlockAverage& diffusion = displacements_.diffusion();
    results.scalars.push_back(
        {prefix + "diffusion", diffusion.mean(kind), diffusion.standard_error(kind)});
  }
  if (solvent_ > 0)
    around_.add_table(this->settings().name, "Solvent around the centre of a molecule", results);
}

template <int D>
void MoleculeStatistics<D>::save(StateWriter& out) const {
  Observer<D>::save(out);
  displacements_.save(out, "centres_");
  around_.save(out);
}

template <int D>
void MoleculeStatistics<D>::load(const StateReader& in) {
  Observer<D>::load(in);
  displacements_.load(in, "centres_", 0);
  around_.load(in);
}

template class MoleculeStatistics<2>;
template class MoleculeStatistics<3>;

}  // namespace odpd
