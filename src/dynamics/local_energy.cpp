#include "odpd/dynamics/local_energy.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "odpd/core/error.h"
#include "odpd/core/index.h"

namespace odpd {

template <int D>
LocalEnergy<D>::LocalEnergy(const Box<D>& box, const PairModel<D>& model,
                            const Surroundings<D>& surroundings, const Particles<D>& particles)
    : box_(box),
      model_(model),
      surroundings_(surroundings),
      particles_(particles),
      grid_(box, model.cutoff(), particles.position),
      around_(index(grid_.cells())),
      members_(around_.size()),
      cell_(particles.position.size()),
      candidates_(particles.position.size()),
      densities_(model.densities()) {
  for (int c = 0; c < D; ++c)
    period_[c] = box.is_periodic(c) ? box.size[c] : std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < around_.size(); ++c)
    grid_.neighbourhood(static_cast<std::int64_t>(c), around_[c]);
}

template <int D>
void LocalEnergy<D>::sort_in() {
  for (auto& cell : members_) cell.clear();
  for (std::size_t i = 0; i < cell_.size(); ++i) {
    const Vec<D>& r = particles_.position[i];
    cell_[i] = grid_.cell_of(r);
    members_[index(cell_[i])].push_back({r, static_cast<std::int32_t>(i)});
  }
  if (densities_ != nullptr) sum_densities();
}

// Distances of all candidates first, without a branch per candidate, which nobody could predict.
template <int D>
std::span<const typename LocalEnergy<D>::Partner> LocalEnergy<D>::partners_of(const Vec<D>& r) {
  const double reach2 = model_.cutoff() * model_.cutoff();
  std::size_t found = 0;
  for (const std::int64_t cell : around_[index(grid_.cell_of(r))])
    for (const Member& other : members_[index(cell)]) {
      double r2 = 0.0;
      for (int c = 0; c < D; ++c) {
        const double d = std::abs(r[c] - other.r[c]);
        const double nearest = std::min(d, period_[c] - d);
        r2 += nearest * nearest;
      }
      candidates_[found] = {r2, other.index};
      found += index(r2 < reach2);
    }
  return {candidates_.data(), found};
}

// Not inside one body, where pairs stay as they are.
template <int D>
bool LocalEnergy<D>::meet(std::size_t i, std::size_t j) const {
  return j != i && !rigid_pair(particles_.group[i], particles_.group[j]);
}

// U_i(r); what i is to the densities there is added to the new ones with this sign.
template <int D>
double LocalEnergy<D>::at(std::size_t i, const Vec<D>& r, double sign) {
  double energy = surroundings_.potential_energy_at(r);
  if (!model_.conservative()) return energy;
  const Site site = site_of(particles_, i);
  const auto partners = partners_of(r);
  for (const Partner& other : partners) {
    const auto j = index(other.index);
    if (!meet(i, j)) continue;
    const double u = model_.pair(std::sqrt(other.r2), site, site_of(particles_, j)).u;
    if (std::isfinite(u) || !model_.excludes(i, j, particles_)) energy += u;
  }
  if (densities_ != nullptr) weigh(i, partners, sign);
  return energy + model_.bonded_energy(i, r, box_, particles_);
}

template <int D>
double LocalEnergy<D>::change(std::span<const std::int32_t> moved, std::span<const Vec<D>> to) {
  moved_.assign(moved.begin(), moved.end());
  to_.assign(to.begin(), to.end());
  for (const NewDensity& one : new_) slot_[index(one.index)] = -1;
  new_.clear();
  double change = 0.0;
  for (std::size_t k = 0; k < moved_.size(); ++k) {
    const auto i = index(moved_[k]);
    const Group group = particles_.group[index(moved_[0])];
    if (k > 0 && (group.is_free() || particles_.group[i] != group))
      throw ConfigError("particles that move at once must be constituents of one body");
    const double there = at(i, to_[k], 1.0), here = at(i, particles_.position[i], -1.0);
    change += there - here;
  }
  return densities_ == nullptr ? change : change + density_change();
}

template <int D>
void LocalEnergy<D>::accept() {
  for (std::size_t k = 0; k < moved_.size(); ++k) move(index(moved_[k]), to_[k]);
  for (const NewDensity& one : new_) density_[index(one.index)] = {one.d, one.psi};
}

template <int D>
void LocalEnergy<D>::sum_densities() {
  const std::size_t n = particles_.position.size();
  density_.resize(n);
  slot_.assign(n, -1);
  new_.clear();
  for (std::size_t i = 0; i < n; ++i) {
    const Site site = site_of(particles_, i);
    double d = densities_->self(site);
    for (const Partner& other : partners_of(particles_.position[i])) {
      const auto j = index(other.index);
      if (j != i) d += densities_->weight(std::sqrt(other.r2), site, site_of(particles_, j)).value;
    }
    density_[i] = {d, densities_->energy(site_of(particles_, i, d)).value};
  }
}

template <int D>
double& LocalEnergy<D>::new_density(std::size_t i) {
  if (slot_[i] < 0) {
    slot_[i] = static_cast<std::int32_t>(new_.size());
    new_.push_back({static_cast<std::int32_t>(i), density_[i].d, 0.0});
  }
  return new_[index(slot_[i])].d;
}

template <int D>
void LocalEnergy<D>::weigh(std::size_t i, std::span<const Partner> partners, double sign) {
  const Site site = site_of(particles_, i);
  double sum = 0.0;
  for (const Partner& other : partners) {
    const auto j = index(other.index);
    if (!meet(i, j)) continue;
    const double w = densities_->weight(std::sqrt(other.r2), site, site_of(particles_, j)).value;
    new_density(j) += sign * w;
    sum += w;
  }
  new_density(i) += sign * sum;
}

template <int D>
double LocalEnergy<D>::density_change() {
  double change = 0.0;
  for (NewDensity& one : new_) {
    const auto i = index(one.index);
    one.psi = densities_->energy(site_of(particles_, i, one.d)).value;
    change += one.psi - density_[i].psi;
  }
  return change;
}

template <int D>
void LocalEnergy<D>::move(std::size_t i, const Vec<D>& r) {
  const auto self = static_cast<std::int32_t>(i);
  auto& from = members_[index(cell_[i])];
  const auto at =
      std::find_if(from.begin(), from.end(), [self](const Member& m) { return m.index == self; });
  const std::int64_t cell = grid_.cell_of(r);
  if (cell == cell_[i]) {
    at->r = r;
    return;
  }
  *at = from.back();
  from.pop_back();
  members_[index(cell)].push_back({r, self});
  cell_[i] = cell;
}

template class LocalEnergy<2>;
template class LocalEnergy<3>;

}  // namespace odpd
