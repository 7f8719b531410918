#include "odpd/pairs/bonds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/pairs/edge_writer.h"

namespace odpd {

namespace {

void validate_bond(const Bond& bond) {
  const BondParameters& p = bond.p;
  const auto refuse = [&](const char* name, double value, const char* range) {
    throw ConfigError(fmt::format("bond of particles {} and {}: {} = {} must be {}", bond.i, bond.j,
                                  name, value, range));
  };
  if (bond.i == bond.j || bond.i < 0 || bond.j < 0)
    throw ConfigError(
        fmt::format("a bond joins two particles, not {} and {}: give two different identities, "
                    "counted from 0",
                    bond.i, bond.j));
  if (!(p.H > 0.0) || !std::isfinite(p.H)) refuse("H", p.H, "positive");
  if (!(p.r_0 >= 0.0) || !std::isfinite(p.r_0)) refuse("r_0", p.r_0, "zero or positive");
  if (p.law == BondLaw::fene && (!(p.r_max > 0.0) || !std::isfinite(p.r_max)))
    refuse("r_max", p.r_max, "positive");
}

}  // namespace

template <int D>
double longest_bond(const Box<D>& box) {
  double half = std::numeric_limits<double>::infinity();
  for (int c = 0; c < D; ++c)
    if (box.is_periodic(c)) half = std::min(half, 0.5 * box.size[c]);
  return half;
}

PairTerms bond_terms(const BondParameters& p, double r) {
  PairTerms t;
  if (p.law == BondLaw::sites) return t;
  const double stretch = r - p.r_0;
  if (p.law == BondLaw::harmonic) {
    t.u = 0.5 * p.H * stretch * stretch;
    t.f_c = -p.H * stretch;
    t.k_c = p.H;
    return t;
  }
  const double x = stretch / p.r_max, left = 1.0 - x * x;
  if (!(left > 0.0)) {
    t.u = std::numeric_limits<double>::infinity();
    return t;
  }
  t.u = -0.5 * p.H * p.r_max * p.r_max * std::log1p(-x * x);
  t.f_c = -p.H * stretch / left;
  t.k_c = p.H * (1.0 + x * x) / (left * left);
  return t;
}

template <int D>
BondedModel<D>::BondedModel(std::shared_ptr<const PairModel<D>> pairs, std::vector<Bond> bonds,
                            std::vector<SiteFrame<D>> frames)
    : pairs_(std::move(pairs)), bonds_(std::move(bonds)), frames_(std::move(frames)) {
  std::set<std::pair<std::int64_t, std::int64_t>> seen;
  std::int64_t last = -1;
  for (const Bond& bond : bonds_) {
    validate_bond(bond);
    if (!seen.insert(std::minmax(bond.i, bond.j)).second)
      throw ConfigError(
          fmt::format("particles {} and {} are bonded twice: give each bond once", bond.i, bond.j));
    last = std::max({last, bond.i, bond.j});
    excludes_ = excludes_ || bond.p.exclude != BondExclusion::none;
  }
  start_.assign(index(last + 2), 0);
  for (const Bond& bond : bonds_)
    for (const std::int64_t id : {bond.i, bond.j}) ++start_[index(id) + 1];
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  bond_of_.resize(start_.back());
  std::vector<std::size_t> place(start_.begin(), start_.end() - 1);
  for (std::size_t k = 0; k < bonds_.size(); ++k)
    for (const std::int64_t id : {bonds_[k].i, bonds_[k].j}) bond_of_[place[index(id)]++] = k;
}

// Memory changes its order every so many steps; that of every single identity tells whether it did.
template <int D>
std::size_t BondedModel<D>::place_of(std::int64_t id, const Particles<D>& particles) const {
  const auto at = index(id);
  if (at >= particles.id.size())
    throw ConfigError(fmt::format("a bond names particle {}, but there are {} particles", id,
                                  particles.id.size()));
  if (index_.size() != particles.id.size() || particles.id[index(index_[at])] != id)
    index_ = particles.index_of_id();
  return index(index_[at]);
}

template <int D>
void BondedModel<D>::write_edges(const PairList<D>& list, const Box<D>& box,
                                 std::span<const Vec<D>> positions, const Particles<D>& particles,
                                 PairNetwork<D>& network) const {
  pairs_->write_edges(list, box, positions, particles, network);
  if (bonds_.empty()) return;
  if (excludes_) exclude(particles, network);
  const std::int64_t pairs = network.size();
  network.resize(pairs + static_cast<std::int64_t>(bonds_.size()));
  const double half_box = longest_bond(box);
  for (std::size_t k = 0; k < bonds_.size(); ++k)
    write_bond(bonds_[k], half_box, box, positions, particles, index(pairs) + k, network);
  network.index_bonds(static_cast<std::int64_t>(bonds_.size()));
  if (frames_.empty()) return;
  network.beyond.assign(bonds_.size(), {});
  for (const SiteFrame<D>& frame : frames_)
    write_frame<D>(frame, points_of(frame, box, positions, particles), index(pairs) + frame.bond,
                   network);
}

// Each next to the first of them: bonds are shorter than half the box.
template <int D>
std::vector<Vec<D>> BondedModel<D>::points_of(const SiteFrame<D>& frame, const Box<D>& box,
                                              std::span<const Vec<D>> positions,
                                              const Particles<D>& particles) const {
  std::vector<Vec<D>> points;
  const Vec<D> first = positions[place_of(frame.first, particles)];
  for (std::size_t k = 0; k < frame.sites.size(); ++k)
    points.push_back(box.separation(
        positions[place_of(frame.first + static_cast<std::int64_t>(k), particles)], first));
  return points;
}

template <int D>
void BondedModel<D>::write_bond(const Bond& bond, double half_box, const Box<D>& box,
                                std::span<const Vec<D>> positions, const Particles<D>& particles,
                                std::size_t k, PairNetwork<D>& network) const {
  const std::size_t i = place_of(bond.i, particles), j = place_of(bond.j, particles);
  const Vec<D> d = box.separation(positions[i], positions[j]);
  const double r = norm(d);
  if (!(r < half_box))
    throw BondTooLongError(
        fmt::format("the bond of particles {} and {} is {:.4g} long, half the shortest periodic "
                    "edge ({:.4g}) or more, where another image may be nearer than the bonded one: "
                    "use a larger box, a larger H or a smaller r_0 (a smaller integrator.dt helps "
                    "only schemes that take bonds explicitly)",
                    bond.i, bond.j, r, half_box),
        bond.i);
  PairTerms t = bond_terms(bond.p, r);
  if (!std::isfinite(t.u))
    throw BlowUpError(
        fmt::format("the fene bond of particles {} and {} is {:.4g} long and reaches from {:.4g} "
                    "to {:.4g} (r_0 -+ r_max): use a smaller integrator.dt, a larger r_max or a "
                    "larger H",
                    bond.i, bond.j, r, bond.p.r_0 - bond.p.r_max, bond.p.r_0 + bond.p.r_max),
        bond.i);
  t.kT = pairs_->pair(r, site_of(particles, i), site_of(particles, j)).kT;
  network.i[k] = static_cast<std::int32_t>(i);
  network.j[k] = static_cast<std::int32_t>(j);
  network.e[k] = r > 0.0 ? (1.0 / r) * d : overlap_direction<D>(bond.i, bond.j);
  network.r[k] = r;
  network.u.set(k, t.u);
  network.f_c[k] = t.f_c;
  network.k_c.set(k, t.k_c);
  network.zeta_par[k] = 0.0;
  network.zeta_perp.set(k, 0.0);
  network.kT.set(k, t.kT);
}

// Force and stiffness that the densities give an edge.
template <int D>
PairTerms BondedModel<D>::of_densities(const Particles<D>& particles, const PairNetwork<D>& network,
                                       std::size_t k) const {
  const DensityColumns& columns = network.densities;
  if (columns.empty()) return {};
  const auto i = index(network.i[k]), j = index(network.j[k]);
  const double slope = columns.psi_1[i] + columns.psi_1[j];
  const Derivatives w =
      densities()->weight(network.r[k], site_of(particles, i), site_of(particles, j));
  return {.f_c = -slope * w.first, .k_c = slope * w.second};
}

template <int D>
void BondedModel<D>::exclude(const Particles<D>& particles, PairNetwork<D>& network) const {
  for (const Bond& bond : bonds_) {
    if (bond.p.exclude == BondExclusion::none) continue;
    const auto [low, high] =
        std::minmax({place_of(bond.i, particles), place_of(bond.j, particles)});
    const auto begin = network.j.begin() + network.first[low];
    const auto end = network.j.begin() + network.first[low + 1];
    const auto at = std::lower_bound(begin, end, static_cast<std::int32_t>(high));
    if (at == end || *at != static_cast<std::int32_t>(high)) continue;
    const auto k = index(at - network.j.begin());
    network.u.set(k, 0.0);
    const PairTerms rest = of_densities(particles, network, k);
    network.f_c[k] = rest.f_c;
    network.k_c.set(k, rest.k_c);
    if (bond.p.exclude != BondExclusion::all) continue;
    network.zeta_par[k] = 0.0;
    network.zeta_perp.set(k, 0.0);
  }
}

template <int D>
double BondedModel<D>::bonded_energy(std::size_t i, const Vec<D>& r, const Box<D>& box,
                                     const Particles<D>& particles) const {
  const auto id = index(particles.id[i]);
  if (id + 1 >= start_.size()) return 0.0;
  const double half_box = longest_bond(box);
  double energy = 0.0;
  for (std::size_t k = start_[id]; k < start_[id + 1]; ++k) {
    const Bond& bond = bonds_[bond_of_[k]];
    const std::size_t j = place_of(bond.i == particles.id[i] ? bond.j : bond.i, particles);
    const double length = norm(box.separation(r, particles.position[j]));
    if (!(length < half_box)) return std::numeric_limits<double>::infinity();
    energy += bond_terms(bond.p, length).u;
    if (bond.p.exclude == BondExclusion::none) continue;
    const double u = pairs_->pair(length, site_of(particles, i), site_of(particles, j)).u;
    if (std::isfinite(u)) energy -= u;  // else it was left out
  }
  return energy + frame_energy(particles.id[i], r, box, particles);
}

template <int D>
bool BondedModel<D>::excludes(std::size_t i, std::size_t j, const Particles<D>& particles) const {
  const std::size_t id = index(particles.id[i]);
  if (id + 1 >= start_.size()) return false;
  for (std::size_t k = start_[id]; k < start_[id + 1]; ++k) {
    const Bond& bond = bonds_[bond_of_[k]];
    const bool joins = bond.i == particles.id[j] || bond.j == particles.id[j];
    if (joins && bond.p.exclude != BondExclusion::none) return true;
  }
  return false;
}

// Of the frame of particle `id`, were that particle at r.
template <int D>
double BondedModel<D>::frame_energy(std::int64_t id, const Vec<D>& r, const Box<D>& box,
                                    const Particles<D>& particles) const {
  const auto after = std::upper_bound(
      frames_.begin(), frames_.end(), id,
      [](std::int64_t wanted, const SiteFrame<D>& frame) { return wanted < frame.first; });
  if (after == frames_.begin()) return 0.0;
  const SiteFrame<D>& frame = *(after - 1);
  const auto at = index(id - frame.first);
  if (at >= frame.sites.size()) return 0.0;
  std::vector<Vec<D>> points = points_of(frame, box, particles.position, particles);
  if (at > 0) {
    points[at] = box.separation(r, particles.position[place_of(frame.first, particles)]);
  } else {
    const Vec<D> shift = box.separation(r, particles.position[place_of(id, particles)]);
    for (std::size_t k = 1; k < points.size(); ++k) points[k] -= shift;
  }
  return 0.5 * frame.H * BalancedFrame<D>(frame, points).distance_squared();
}

template double longest_bond<2>(const Box<2>&);
template double longest_bond<3>(const Box<3>&);
template class BondedModel<2>;
template class BondedModel<3>;

}  // namespace odpd
