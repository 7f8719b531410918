#include "odpd/scene/start_bonds.h"

#include <fmt/format.h>

#include <cmath>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/particles/rigid_body.h"

namespace odpd {

namespace {

// Particles of a start file, by their order in it.
template <int D>
struct StartParticles {
  const SceneSettings<D>& settings;
  const Particles<D>& particles;
  std::vector<std::int32_t> index_of = particles.index_of_id();
  std::int64_t first =
      particles.size() - static_cast<std::int64_t>(settings.start_positions.size());

  std::int64_t row(std::int64_t id) const { return id - first; }
  const Vec<D>& position(std::int64_t id) const {
    return particles.position[index(index_of[index(id)])];
  }
};

template <int D>
void check_length(const StartParticles<D>& start, const Bond& bond) {
  const Box<D>& box = start.settings.box;
  const double r = norm(box.separation(start.position(bond.i), start.position(bond.j)));
  const auto refuse = [&](const std::string& why) {
    throw ConfigError(fmt::format("{}: the bond of its particles {} and {} is {:.4g} long, {}",
                                  start.settings.start_file, start.row(bond.i), start.row(bond.j),
                                  r, why));
  };
  if (!(r < longest_bond(box)))
    refuse(fmt::format(
        "half the shortest periodic edge ({:.4g}) or more: put them nearer to each other, or use a "
        "larger box",
        longest_bond(box)));
  if (!std::isfinite(bond_terms(bond.p, r).u))
    refuse(fmt::format(
        "but it reaches from {:.4g} to {:.4g} (r_0 -+ r_max): put them within it, or use a larger "
        "r_max",
        bond.p.r_0 - bond.p.r_max, bond.p.r_0 + bond.p.r_max));
}

template <int D>
void check_handedness(const StartParticles<D>& start, double kT, const MoleculeSettings<D>& kind,
                      std::int64_t first) {
  SiteFrame<D> frame{first, 0, kind.shape, kind.site_H};
  std::vector<Vec<D>> places;
  for (std::int64_t k = 0; k < kind.beads(); ++k)
    places.push_back(
        start.settings.box.separation(start.position(first + k), start.position(first)));
  const BalancedFrame<D> balanced(frame, places);
  const double off = balanced.distance_squared();
  for (Vec<D>& site : frame.sites) site[0] = -site[0];
  const double mirrored = BalancedFrame<D>(frame, places).distance_squared();
  const auto refuse = [&](const char* how) {
    throw ConfigError(
        fmt::format("{}: its particles {} to {}, which are tied to the sites of a "
                    "[[molecule]] '{}', lie {}",
                    start.settings.start_file, start.row(first),
                    start.row(first) + kind.beads() - 1, kind.name, how));
  };
  if (!turn_under<D>(balanced.arms, balanced.arms, Vec<D>{}))
    refuse(
        "on a line or in one point, where their frame may turn freely: place them as in the shape");
  if (mirrored < 0.1 * off && 0.5 * kind.site_H * off > 20.0 * kT)
    refuse(
        "as the mirror image of its shape, which no rotation makes fit: list them in the "
        "order of the shape's beads (of a simplex: exchange any two of them), or mirror the shape");
}

}  // namespace

template <int D>
void check_start_bonds(const SceneSettings<D>& settings, double kT,
                       const std::vector<Molecule>& molecules, const std::vector<Bond>& bonds,
                       const Particles<D>& particles) {
  if (settings.start != StartKind::file) return;
  const StartParticles<D> start{settings, particles};
  for (const Bond& bond : bonds) check_length(start, bond);
  for (const Molecule& m : molecules)
    if (settings.molecules[m.kind].site_H > 0.0)
      check_handedness(start, kT, settings.molecules[m.kind], m.first);
}

template void check_start_bonds<2>(const SceneSettings<2>&, double, const std::vector<Molecule>&,
                                   const std::vector<Bond>&, const Particles<2>&);
template void check_start_bonds<3>(const SceneSettings<3>&, double, const std::vector<Molecule>&,
                                   const std::vector<Bond>&, const Particles<3>&);

}  // namespace odpd
