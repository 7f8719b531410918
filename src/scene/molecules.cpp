#include "odpd/scene/molecules.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <queue>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/core/random.h"
#include "odpd/scene/bodies.h"
#include "odpd/scene/body_room.h"
#include "odpd/scene/fill.h"
#include "odpd/scene/random_places.h"

namespace odpd {

namespace {

constexpr std::uint64_t most_places = 10000, most_directions = 1000;

// Finds places for the beads of molecules.
template <int D>
class Room {
 public:
  Room(const Box<D>& box, const Vec<D>& low, const Vec<D>& high, std::uint64_t seed,
       const Particles<D>& particles)
      : box_(box),
        low_(low),
        high_(high),
        random_(seed, Stream::molecules),
        bodies_(box, particles) {}

  /// Unwrapped positions of the beads of molecule `number`; none where there is no room.
  std::vector<Vec<D>> beads(const MoleculeSettings<D>& m, std::uint64_t number,
                            const Vec<D>* at) const {
    for (std::uint64_t attempt = 0; attempt < most_places; ++attempt) {
      std::vector<Vec<D>> beads =
          m.walk > 0.0 ? walk(m, attempt, number) : turned(m, attempt, number, at);
      if (!beads.empty()) return beads;
    }
    return {};
  }

 private:
  bool is_open(Vec<D> r) const {
    for (int c = 0; c < D; ++c)
      if (!box_.is_periodic(c) && !(r[c] >= low_[c] && r[c] <= high_[c])) return false;
    box_.wrap(r);
    return !bodies_.holds(r);
  }

  // `at`: where it is to be; else anywhere.
  Vec<D> centre(std::uint64_t attempt, std::uint64_t number, const Vec<D>* at) const {
    if (at != nullptr) return *at;
    const auto u = random_.uniforms(attempt, 0, number, 0);
    Vec<D> r;
    for (int c = 0; c < D; ++c) r[c] = low_[c] + (high_[c] - low_[c]) * u[index(c)];
    return r;
  }

  std::vector<Vec<D>> turned(const MoleculeSettings<D>& m, std::uint64_t attempt,
                             std::uint64_t number, const Vec<D>* at) const {
    Rotation<D> orientation;
    turn_at_random(random_.uniforms(attempt, 1, number, 0), orientation);
    std::vector<Vec<D>> beads;
    for (const Vec<D>& bead : m.shape) {
      beads.push_back(centre(attempt, number, at) + orientation.turn(bead));
      if (!is_open(beads.back())) return {};
    }
    return beads;
  }

  std::vector<Vec<D>> walk(const MoleculeSettings<D>& m, std::uint64_t attempt,
                           std::uint64_t number) const {
    std::vector<Vec<D>> beads{centre(attempt, number, nullptr)};
    if (!is_open(beads[0])) return {};
    while (beads.size() < m.shape.size()) {
      Vec<D> next{};
      for (std::uint64_t turn = 0;; ++turn) {
        if (turn == most_directions) return {};
        const auto n = random_.normals(attempt, 2 + turn, number, beads.size());
        Vec<D> direction;
        for (int c = 0; c < D; ++c) direction[c] = n[index(c)];
        next = beads.back() + (m.walk / norm(direction)) * direction;
        if (is_open(next)) break;
      }
      beads.push_back(next);
    }
    return beads;
  }

  const Box<D>& box_;
  Vec<D> low_, high_;
  CounterRandom random_;
  const BodyRoom<D> bodies_;
};

// Centres of all molecules that keep clear of each other, of all others with known places and of bodies, in the order of the entries.
template <int D>
std::vector<Vec<D>> clear_places(const std::vector<MoleculeSettings<D>>& settings,
                                 const Box<D>& box, const Vec<D>& low, const Vec<D>& high,
                                 std::uint64_t seed, const Particles<D>& particles) {
  BallCells<D> there(box);
  std::vector<double> radii;
  double volume = 0.0;
  std::string name;
  for (const RigidBody<D>& body : particles.bodies) {
    double radius = 0.0;
    for (const Vec<D>& b : body.frame) radius = std::max(radius, norm(b));
    there.add(body.pose.centre, radius);
  }
  for (const MoleculeSettings<D>& m : settings) {
    double radius = 0.5 * m.clearance;
    for (const Vec<D>& b : m.shape) radius = std::max(radius, norm(b) + 0.5 * m.clearance);
    for (Vec<D> centre : m.positions) {
      box.wrap(centre);
      there.add(centre, radius);
    }
    if (!m.positions.empty() || m.clearance == 0.0) continue;
    radii.insert(radii.end(), index(m.count), radius);
    volume += static_cast<double>(m.count) * unit_ball_volume<D> * std::pow(radius, D);
    name = m.name;
  }
  if (radii.empty()) return {};
  const double share = volume / Box<D>{high - low, {}}.volume();
  RandomPlaces<D> found{.centres = {}, .attempts = {}, .scale = 0.0};
  // Bodies have tried the places of the seed itself.
  if (share < 1.0) found = find_random_places<D>(box, low, high, there, radii, seed + 1);
  if (found.scale < 1.0)
    throw ConfigError(fmt::format(
        "[[molecule]] '{}': no places were found for {} molecules that keep their clearance: with "
        "half of it around each they would fill {:.3g} of the space; lower count or clearance, "
        "give positions, or use a larger box",
        name, radii.size(), share));
  return found.centres;
}

}  // namespace

template <int D>
std::vector<Molecule> list_molecules(const std::vector<MoleculeSettings<D>>& settings,
                                     std::int64_t first) {
  std::vector<Molecule> molecules;
  for (std::size_t kind = 0; kind < settings.size(); ++kind)
    for (std::int64_t n = 0; n < settings[kind].molecules(); ++n) {
      molecules.push_back({kind, first});
      first += settings[kind].beads();
    }
  return molecules;
}

template <int D>
std::vector<Bond> bonds_of(const std::vector<MoleculeSettings<D>>& settings,
                           const std::vector<Molecule>& molecules) {
  std::vector<Bond> bonds;
  for (const Molecule& m : molecules)
    for (const auto& link : settings[m.kind].bonds)
      bonds.push_back({m.first + link.i, m.first + link.j, link.p});
  return bonds;
}

template <int D>
std::vector<SiteFrame<D>> frames_of(const std::vector<MoleculeSettings<D>>& settings,
                                    const std::vector<Molecule>& molecules) {
  std::vector<SiteFrame<D>> frames;
  std::size_t bond = 0;
  for (const Molecule& m : molecules) {
    const MoleculeSettings<D>& kind = settings[m.kind];
    if (kind.site_H > 0.0) frames.push_back({m.first, bond, kind.shape, kind.site_H});
    bond += kind.bonds.size();
  }
  return frames;
}

template <int D>
void place_molecules(const std::vector<MoleculeSettings<D>>& settings, const Box<D>& box,
                     const Vec<D>& low, const Vec<D>& high, std::uint64_t seed,
                     Particles<D>& particles) {
  const Room<D> room(box, low, high, seed, particles);
  const std::vector<Vec<D>> places = clear_places(settings, box, low, high, seed, particles);
  std::uint64_t number = 0;
  std::size_t place = 0;
  for (const MoleculeSettings<D>& m : settings)
    for (std::int64_t n = 0; n < m.molecules(); ++n) {
      std::vector<Vec<D>> beads = m.shape;
      if (m.positions.empty()) {
        const bool clear = m.clearance > 0.0;
        beads = room.beads(m, number++, clear ? &places[place++] : nullptr);
        if (beads.empty())
          throw ConfigError(fmt::format(
              "[[molecule]] '{}': no room was found for molecule {} of {}: use a larger "
              "box, or give positions",
              m.name, n + 1, m.molecules()));
      } else {
        for (Vec<D>& r : beads) r += m.positions[index(n)];
      }
      for (std::size_t k = 0; k < beads.size(); ++k) {
        particles.add(beads[k], m.species[k]);
        box.wrap(particles.position.back());
      }
    }
}

template <int D>
void join_images(const std::vector<Bond>& bonds, const Box<D>& box, Particles<D>& particles) {
  const std::vector<std::int32_t> index_of = particles.index_of_id();
  std::vector<std::vector<std::size_t>> partners(index_of.size());
  const auto at = [&](std::int64_t id) { return index(index_of[index(id)]); };
  for (const Bond& bond : bonds) {
    partners[at(bond.i)].push_back(at(bond.j));
    partners[at(bond.j)].push_back(at(bond.i));
  }
  std::vector<char> joined(index_of.size(), 0);
  for (const Bond& bond : bonds) {
    std::queue<std::size_t> waiting;
    if (joined[at(bond.i)] == 0) waiting.push(at(bond.i));
    for (; !waiting.empty(); waiting.pop()) {
      const std::size_t i = waiting.front();
      joined[i] = 1;
      for (const std::size_t j : partners[i]) {
        if (joined[j] != 0) continue;
        joined[j] = 1;
        waiting.push(j);
        const Vec<D> near = box.separation(particles.position[j], particles.position[i]);
        const Vec<D> apart = particles.position[j] - particles.position[i];
        for (std::size_t c = 0; c < D; ++c)
          particles.image[j][c] =
              particles.image[i][c] +
              static_cast<std::int32_t>(std::lround((near.x[c] - apart.x[c]) / box.size.x[c]));
      }
    }
  }
}

#define ODPD_INSTANTIATE(D)                                                                     \
  template std::vector<Molecule> list_molecules<D>(const std::vector<MoleculeSettings<D>>&,     \
                                                   std::int64_t);                               \
  template std::vector<Bond> bonds_of<D>(const std::vector<MoleculeSettings<D>>&,               \
                                         const std::vector<Molecule>&);                         \
  template std::vector<SiteFrame<D>> frames_of<D>(const std::vector<MoleculeSettings<D>>&,      \
                                                  const std::vector<Molecule>&);                \
  template void place_molecules<D>(const std::vector<MoleculeSettings<D>>&, const Box<D>&,      \
                                   const Vec<D>&, const Vec<D>&, std::uint64_t, Particles<D>&); \
  template void join_images<D>(const std::vector<Bond>&, const Box<D>&, Particles<D>&);
ODPD_INSTANTIATE(2)
ODPD_INSTANTIATE(3)
#undef ODPD_INSTANTIATE

}  // namespace odpd
