#pragma once
// A toy model with densities, its energy by the definition, and a crowd of particles to try it on.
//
//   E = pair sum_pairs x^5 + c sum_i d_i^2,   d_i = 1 + sum_{j != i} b x^5,   x = 1 - (r/r_c)^2
//
// b is 1 between particles of one species and 0.6 between two; c is 0.7 c for species 1. Friction as DPD's, times
// 1 + crowding (d_i + d_j).
#include <vector>

#include "odpd/geometry/pair_list.h"
#include "odpd/pairs/density_writer.h"
#include "support/points.h"
#include "support/simplex.h"

namespace support {

struct ToyParameters {
  double c = 1.0, pair = 0.0, gamma = 4.5, crowding = 0.0, cutoff = 1.0, kT = 1.0;
  bool forgets = false;  ///< the psi' of the partner: what a wrong gradient would be
};

class ToyDensities final : public odpd::Densities {
 public:
  explicit ToyDensities(const ToyParameters& p) : p_(p) {}
  double self(odpd::Site) const override { return 1.0; }
  odpd::Derivatives weight(double r, odpd::Site i, odpd::Site j) const override {
    return times(i.species == j.species ? 1.0 : 0.6, bump(r));
  }
  odpd::Derivatives energy(odpd::Site site) const override {
    const double c = site.species == 0 ? p_.c : 0.7 * p_.c, d = site.density;
    return {c * d * d, 2.0 * c * d, 2.0 * c};
  }
  /// x^5.
  odpd::Derivatives bump(double r) const {
    const double q = r / p_.cutoff, x = 1.0 - q * q;
    if (!(x > 0.0)) return {};
    const double x3 = x * x * x;
    return {x3 * x * x, -10.0 * q * x3 * x / p_.cutoff,
            (80.0 * q * q * x3 - 10.0 * x3 * x) / (p_.cutoff * p_.cutoff)};
  }

 private:
  static odpd::Derivatives times(double b, const odpd::Derivatives& w) {
    return {b * w.value, b * w.first, b * w.second};
  }
  ToyParameters p_;
};

template <int D>
class ToyModel : public odpd::PairModel<D> {
 public:
  explicit ToyModel(const ToyParameters& p) : p_(p), densities_(p) {}

  double cutoff() const override { return p_.cutoff; }
  odpd::PairTerms pair(double r, odpd::Site i, odpd::Site j) const override {
    return terms(r, i, j);
  }
  void write_edges(const odpd::PairList<D>& list, const odpd::Box<D>& box,
                   std::span<const odpd::Vec<D>> positions, const odpd::Particles<D>& particles,
                   odpd::PairNetwork<D>& network) const override {
    write_density_terms(
        densities_, [this](double r, odpd::Site i, odpd::Site j) { return terms(r, i, j); },
        p_.cutoff, list, box, positions, particles, network);
    for (std::size_t k = 0; p_.forgets && k < network.f_c.size(); ++k) network.f_c[k] *= 0.5;
  }
  const odpd::Densities* densities() const override { return &densities_; }
  bool conservative() const override { return true; }
  bool thermal() const override { return p_.kT > 0.0; }

 private:
  odpd::PairTerms terms(double r, odpd::Site i, odpd::Site j) const {
    const odpd::Derivatives u = densities_.bump(r);
    const double x = 1.0 - r / p_.cutoff;
    odpd::PairTerms t;
    t.u = p_.pair * u.value;
    t.f_c = -p_.pair * u.first;
    t.k_c = p_.pair * u.second;
    t.zeta_par =
        x > 0.0 ? p_.gamma * std::sqrt(x) * (1.0 + p_.crowding * (i.density + j.density)) : 0.0;
    t.kT = p_.kT;
    return t;
  }
  ToyParameters p_;
  ToyDensities densities_;
};

/// Particles at random places of a periodic box, half of them of species 1, in random order in memory: two walls of known
/// velocity next to each other, a rigid body, a body of known motion that touches a wall, and free ones.
template <int D>
struct Crowd {
  odpd::Box<D> box;
  odpd::Particles<D> particles;
  odpd::PairNetwork<D> network;

  explicit Crowd(std::size_t count, double edge = 3.2, bool only_free = false) {
    box.size = uniform_vec<D>(edge);
    box.periodic.fill(true);
    particles.walls = only_free ? 0 : 2;
    for (const odpd::Vec<D>& r : random_points<D>({}, box.size, count, 5)) {
      const auto group = odpd::Group::of_code(only_free || r[0] > 0.8 ? 0
                                              : r[1] < 0.5 * edge     ? 1
                                                                      : 2);
      particles.add(r, particles.size() % 2 == 0 ? 0 : 1, group);
    }
    for (const bool known : {false, true}) {
      if (only_free) break;
      odpd::RigidBody<D> body = simplex_body<D>();
      body.known = known;
      body.pose.centre = uniform_vec<D>(known ? 0.9 : 2.5);
      particles.add_body(body, box, 1);
    }
    particles.reorder(random_order(particles.position.size(), 4));
  }
  void connect(const odpd::PairModel<D>& model, double skin = 0.0) {
    odpd::PairList<D> list(box, model.cutoff(), skin);
    list.update(particles.position);
    model.write_edges(list, box, particles.position, particles, network);
  }
  /// d of each particle from all pairs, those that are no edges too.
  std::vector<double> densities(const odpd::PairModel<D>& model) const {
    const odpd::Densities& functions = *model.densities();
    std::vector<double> d;
    for (std::size_t i = 0; i < particles.position.size(); ++i) {
      d.push_back(functions.self(site_of(particles, i)));
      for (std::size_t j = 0; j < particles.position.size(); ++j)
        if (j != i)
          d[i] +=
              functions.weight(distance(i, j), site_of(particles, i), site_of(particles, j)).value;
    }
    return d;
  }
  /// The energy by the definition: pairs that are edges, and psi of all particles.
  double energy(const odpd::PairModel<D>& model) const {
    const std::vector<double> d = densities(model);
    double energy = 0.0;
    for (std::size_t i = 0; i < d.size(); ++i) {
      energy += model.densities()->energy(site_of(particles, i, d[i])).value;
      for (std::size_t j = 0; j < i; ++j)
        if (!rigid(i, j))
          energy += model.pair(distance(i, j), site_of(particles, i), site_of(particles, j)).u;
    }
    return energy;
  }
  bool rigid(std::size_t i, std::size_t j) const {
    const bool one_body = particles.body_of(i) >= 0 && particles.body_of(i) == particles.body_of(j);
    return one_body || (particles.is_known(i) && particles.is_known(j));
  }
  double distance(std::size_t i, std::size_t j) const {
    return norm(box.separation(particles.position[i], particles.position[j]));
  }
};

}  // namespace support
