#include "odpd/dynamics/local_energy.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace odpd {

template <int D>
LocalEnergy<D>::LocalEnergy(const Box<D>& box, const PairModel<D>& model,
                            const Surroundings<D>& surroundings, const Particles<D>& particles)
    : box_(box),
      model_(model),
      surroundings_(surroundings),
      particles_(particles),
      grid_(box, model.cutoff(), particles.position),
      around_(static_cast<std::size_t>(grid_.cells())),
      members_(around_.size()),
      cell_(particles.position.size()),
      candidates_(particles.position.size()) {
  for (int c = 0; c < D; ++c)
    period_[c] = box.is_periodic(c) ? box.size[c] : std::numeric_limits<double>::infinity();
  for (std::size_t c = 0; c < around_.size(); ++c)
    grid_.neighbourhood(static_cast<std::int64_t>(c), around_[c]);
}

template <int D>
void LocalEnergy<D>::place() {
  for (auto& cell : members_) cell.clear();
  for (std::size_t i = 0; i < cell_.size(); ++i) {
    const Vec<D>& r = particles_.position[i];
    cell_[i] = grid_.cell_of(r);
    members_[static_cast<std::size_t>(cell_[i])].push_back({r, static_cast<std::int32_t>(i)});
  }
}

// Distances of all candidates first, without a branch per candidate, which nobody could predict.
template <int D>
std::span<const typename LocalEnergy<D>::Partner> LocalEnergy<D>::partners_of(const Vec<D>& r) {
  const double reach2 = model_.cutoff() * model_.cutoff();
  std::size_t found = 0;
  for (const std::int64_t cell : around_[static_cast<std::size_t>(grid_.cell_of(r))])
    for (const Member& other : members_[static_cast<std::size_t>(cell)]) {
      double r2 = 0.0;
      for (int c = 0; c < D; ++c) {
        const double d = std::abs(r[c] - other.r[c]);
        const double nearest = std::min(d, period_[c] - d);
        r2 += nearest * nearest;
      }
      candidates_[found] = {r2, other.index};
      found += static_cast<std::size_t>(r2 < reach2);
    }
  return {candidates_.data(), found};
}

template <int D>
double LocalEnergy<D>::at(std::size_t i, const Vec<D>& r) {
  double energy = surroundings_.potential_energy_at(r);
  if (!model_.conservative()) return energy;
  const Site site{particles_.species[i]};
  for (const Partner& other : partners_of(r)) {
    const auto j = static_cast<std::size_t>(other.index);
    const bool inside = particles_.group[i] != 0 && particles_.group[i] == particles_.group[j];
    if (j != i && !inside)
      energy += model_.pair(std::sqrt(other.r2), site, Site{particles_.species[j]}).u;
  }
  return energy + model_.bonded_energy(i, r, box_, particles_);
}

template <int D>
void LocalEnergy<D>::moved(std::size_t i, const Vec<D>& r) {
  const auto self = static_cast<std::int32_t>(i);
  auto& from = members_[static_cast<std::size_t>(cell_[i])];
  const auto at =
      std::find_if(from.begin(), from.end(), [self](const Member& m) { return m.index == self; });
  const std::int64_t cell = grid_.cell_of(r);
  if (cell == cell_[i]) {
    at->r = r;
    return;
  }
  *at = from.back();
  from.pop_back();
  members_[static_cast<std::size_t>(cell)].push_back({r, self});
  cell_[i] = cell;
}

template class LocalEnergy<2>;
template class LocalEnergy<3>;

}  // namespace odpd
