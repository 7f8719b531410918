// What every pair model owes every solver: R symmetric, semidefinite, with the null space of its
// geometry, and noise of covariance 2 kT R / dt (Phan-Thien et al. 2016, eq. 14-18).
#include <gtest/gtest.h>

#include <cmath>

#include "contract.h"
#include "odpd/operator/edge_sums.h"
#include "odpd/pairs/noise.h"

namespace {

using contract::Geometry;
using contract::Instant;
using contract::Model;
using contract::product;
using odpd::Vec;

using Case = std::tuple<Model, Geometry, int>;

class Operator : public ::testing::TestWithParam<Case> {
 protected:
  Model model() const { return std::get<0>(GetParam()); }
  Geometry geometry() const { return std::get<1>(GetParam()); }
  /// check(instant) in the dimension of the case.
  template <class Check>
  void run(const Check& check) const {
    if (std::get<2>(GetParam()) == 2) {
      check(contract::instant_of<2>(model(), geometry(), 4.0));
    } else {
      check(contract::instant_of<3>(model(), geometry(), 3.1));
    }
  }
};

INSTANTIATE_TEST_SUITE_P(
    AllModels, Operator,
    ::testing::Combine(::testing::Values(Model::central, Model::transverse, Model::far_friction),
                       ::testing::Values(Geometry::walls, Geometry::periodic, Geometry::open),
                       ::testing::Values(2, 3)),
    [](const auto& test) {
      return contract::name(std::get<0>(test.param)) + "_" +
             contract::name(std::get<1>(test.param)) + "_" +
             std::to_string(std::get<2>(test.param)) + "D";
    });

template <int D>
std::vector<double> random_unknowns(const Instant<D>& instant, std::uint64_t seed) {
  return support::random_numbers(instant.load.size(), seed);
}

// One number per node from its position, as unknowns.
template <int D, class Field>
std::vector<double> unknowns_of(const Instant<D>& instant, const Field& field) {
  std::vector<double> x;
  const auto r = instant.resistance().positions();
  for (std::size_t n = 0; n < static_cast<std::size_t>(instant.resistance().nodes()); ++n) {
    Vec<D> place;
    for (std::size_t c = 0; c < D; ++c) place.x[c] = r[n * D + c];
    const Vec<D> v = field(place);
    x.insert(x.end(), v.x.begin(), v.x.end());
  }
  return x;
}

// Smallest pivot of the Cholesky factorisation of A + shift I, negative when A + shift I is not
// definite.
double smallest_pivot(const odpd::System& system, double shift) {
  const auto n = static_cast<std::size_t>(system.size());
  std::vector<double> a(n * n), unit(n, 0.0), column(n);
  for (std::size_t c = 0; c < n; ++c) {
    unit[c] = 1.0;
    system.apply(unit, column);
    unit[c] = 0.0;
    for (std::size_t r = 0; r < n; ++r) a[r * n + c] = column[r];
    a[c * n + c] += shift;
  }
  double smallest = 1e300;
  for (std::size_t p = 0; p < n; ++p) {
    const double pivot = a[p * n + p];
    smallest = std::min(smallest, pivot);
    if (!(pivot > 0.0)) return smallest;
    for (std::size_t r = p + 1; r < n; ++r) {
      const double factor = a[r * n + p] / pivot;
      if (factor == 0.0) continue;
      for (std::size_t c = p + 1; c < n; ++c) a[r * n + c] -= factor * a[p * n + c];
    }
  }
  return smallest;
}

TEST_P(Operator, IsSymmetric) {
  run([&]<int D>(const Instant<D>& instant) {
    for (std::uint64_t k = 0; k < 5; ++k) {
      const auto x = random_unknowns(instant, 2 * k), y = random_unknowns(instant, 2 * k + 1);
      const auto rx = product(instant.resistance(), x), ry = product(instant.resistance(), y);
      EXPECT_NEAR(support::dot(x, ry), support::dot(y, rx),
                  1e-13 * support::norm(x) * support::norm(ry));
    }
  });
}

// With a shift of 1e-9 of its size R is definite, so no eigenvalue lies below -1e-9; with walls it
// is definite without one.
TEST_P(Operator, IsPositiveSemidefinite) {
  run([&]<int D>(const Instant<D>& instant) {
    EXPECT_GT(smallest_pivot(instant.resistance(), 1e-8), 0.0);
    const double alone = smallest_pivot(instant.resistance(), 0.0);
    if (geometry() == Geometry::walls) {
      EXPECT_GT(alone, 1e-3);
    } else {
      EXPECT_LT(alone, 1e-8) << "translations must cost nothing";
      EXPECT_LT(smallest_pivot(instant.resistance(), -1e-8), 0.0) << "the test can tell";
    }
  });
}

TEST_P(Operator, TranslationsAreNullUnlessWallsHoldThem) {
  run([&]<int D>(const Instant<D>& instant) {
    EXPECT_EQ(instant.resistance().translations_are_null(), geometry() != Geometry::walls);
    for (int c = 0; c < D; ++c) {
      const auto x = unknowns_of(instant, [&](const Vec<D>&) {
        Vec<D> v{};
        v[c] = 1.0;
        return v;
      });
      const double drag = support::norm(product(instant.resistance(), x)) / support::norm(x);
      if (geometry() == Geometry::walls) {
        EXPECT_GT(drag, 0.1);
      } else {
        EXPECT_LT(drag, 1e-12);
      }
    }
  });
}

TEST_P(Operator, RotationsAreNullForCentralFrictionInTheOpen) {
  run([&]<int D>(const Instant<D>& instant) {
    for (int a = 0; a < D; ++a) {
      for (int b = 0; b < a; ++b) {
        const auto x = unknowns_of(instant, [&](const Vec<D>& r) {
          Vec<D> v{};
          v[a] = r[b];
          v[b] = -r[a];
          return v;
        });
        const double drag = support::norm(product(instant.resistance(), x)) / support::norm(x);
        if (geometry() == Geometry::open && model() != Model::transverse) {
          EXPECT_LT(drag, 1e-12);
        } else {
          EXPECT_GT(drag, 1e-2) << "across the border, the walls or e there is friction";
        }
      }
    }
  });
}

TEST_P(Operator, NoiseHasTheCovarianceOfFluctuationDissipation) {
  run([&]<int D>(const Instant<D>& instant) {
    contract::expect_noise_covariance(instant, instant.resistance());
  });
}

TEST_P(Operator, PairForcesCancelInTheSum) {
  run([&]<int D>(const Instant<D>& instant) {
    const auto& network = instant.stage.network;
    const auto n = instant.stage.position.size();
    std::vector<Vec<D>> conservative(n), friction(n), noise(n), on_edges;
    odpd::add_conservative_forces(network, conservative);
    odpd::add_friction_forces<D>(network, support::random_vectors<D>(n, 4), friction);
    odpd::draw_edge_noise(network, instant.scene.particles(), 1, 2, 0.01, on_edges);
    odpd::add_edge_forces<D>(network, on_edges, noise);
    for (const auto* force : {&conservative, &friction, &noise}) {
      Vec<D> total{};
      double size = 0.0;
      for (const Vec<D>& f : *force) {
        total += f;
        size += norm(f);
      }
      EXPECT_GT(size, 1.0);
      EXPECT_LT(norm(total), 1e-13 * size) << "walls feel what the fluid feels";
    }
  });
}

// The right-hand side is P^T (F_C + F_ext - R v_known) + xi, put together here from the edges.
TEST_P(Operator, TheLoadIsForcesMinusDragOfTheWallsPlusNoise) {
  run([&]<int D>(const Instant<D>& instant) {
    const auto& network = instant.stage.network;
    const auto& particles = instant.scene.particles();
    std::vector<Vec<D>> on_edges, force(instant.stage.position.size());
    odpd::draw_edge_noise(network, particles, 1, 3, 0.01, on_edges);
    for (std::size_t k = 0; k < on_edges.size(); ++k) {
      const auto i = static_cast<std::size_t>(network.i[k]);
      const auto j = static_cast<std::size_t>(network.j[k]);
      const auto known = [&](std::size_t p) {
        return particles.is_free(p) ? Vec<D>{}
                                    : instant.scene.known_velocity(particles.group[p], 0.0);
      };
      const Vec<D> slip = known(i) - known(j);
      const Vec<D> along = dot(slip, network.e[k]) * network.e[k];
      const Vec<D> on_i = network.f_c[k] * network.e[k] + on_edges[k] -
                          network.zeta_par[k] * along - network.zeta_perp[k] * (slip - along);
      force[i] += on_i;
      force[j] -= on_i;
    }
    instant.scene.add_potential_forces(particles, instant.stage.position, force);
    instant.scene.add_driving_forces(particles, particles.position, 0.0, force);
    std::vector<double> load;
    odpd::DofMap<D>(particles).gather({}, force, load);
    for (std::size_t k = 0; k < load.size(); ++k) EXPECT_NEAR(load[k], instant.load[k], 1e-10);
  });
}

}  // namespace
