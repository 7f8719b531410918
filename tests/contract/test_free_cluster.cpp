// Every solver on a cluster that floats free: central friction leaves its translations and rotations without resistance, and
// loads of central pair forces have an answer. It is the one of least norm: no momentum, no angular momentum.
#include <gtest/gtest.h>

#include "contract.h"
#include "odpd/core/rotation.h"

namespace {

enum class Shape { simplex, drop, large };

template <int D>
struct FreeCluster : support::Fluid<D> {
  /// Corners of a simplex, a drop of random points, or (2D) one of many; across the faces of its periodic box.
  explicit FreeCluster(Shape shape) : support::Fluid<D>{shape == Shape::large ? 22.0 : 6.0, true} {
    if (shape == Shape::large) {
      for (int k = 0; k < 1600; ++k) {
        odpd::Vec<D> r{};
        r[0] = 0.45 * (k % 40) + 0.1 * std::sin(7.0 * k);
        r[1] = 0.45 * (k / 40) + 0.1 * std::cos(5.0 * k);
        unwrapped.push_back(r);
      }
    } else if (shape == Shape::simplex) {
      unwrapped.assign(D + 1, odpd::Vec<D>{});
      for (int c = 0; c < D; ++c) unwrapped[static_cast<std::size_t>(c) + 1][c] = 0.6 - 0.1 * c;
    } else {
      unwrapped = support::random_points<D>(support::uniform_vec<D>(-0.6),
                                            support::uniform_vec<D>(0.6), D == 2 ? 25 : 60, 1);
    }
    for (odpd::Vec<D> r : unwrapped) {
      this->box.wrap(r);
      this->particles.add(r, 0);
    }
    this->connect(odpd::DpdModel<D>(1, {odpd::DpdParameters{}}));
    resistance.rebuild(this->network, odpd::DofMap<D>(this->particles), this->particles,
                       this->particles.position, 0.0);
  }

  /// Random forces along the edges.
  std::vector<double> central_load(std::uint64_t seed) const {
    std::vector<double> f(static_cast<std::size_t>(resistance.size()));
    const auto strength = support::random_numbers(this->network.i.size(), seed);
    for (std::size_t k = 0; k < strength.size(); ++k)
      for (std::size_t c = 0; c < D; ++c) {
        f[static_cast<std::size_t>(this->network.i[k]) * D + c] +=
            strength[k] * this->network.e[k].x[c];
        f[static_cast<std::size_t>(this->network.j[k]) * D + c] -=
            strength[k] * this->network.e[k].x[c];
      }
    return f;
  }

  /// Momentum and angular momentum about the centre, per mass.
  std::vector<double> momenta(const std::vector<double>& v) const {
    odpd::Vec<D> centre{}, p{}, l{};
    for (const auto& r : unwrapped) centre += (1.0 / static_cast<double>(unwrapped.size())) * r;
    for (std::size_t n = 0; n < unwrapped.size(); ++n) {
      odpd::Vec<D> own;
      for (std::size_t c = 0; c < D; ++c) own.x[c] = v[n * D + c];
      p += own;
      l += odpd::torque(unwrapped[n] - centre, own);
    }
    std::vector<double> all(p.x.begin(), p.x.end());
    all.insert(all.end(), l.x.begin(), l.x.end());
    return all;
  }

  std::vector<odpd::Vec<D>> unwrapped;
  odpd::Resistance<D> resistance{this->box};
};

/// |b - R x| / |b|: nothing projected.
template <int D>
double plain_residual(const FreeCluster<D>& cluster, const std::vector<double>& b,
                      const std::vector<double>& x) {
  return contract::distance(contract::product(cluster.resistance, x), b);
}

template <int D>
void expect_least_answer(const odpd::SolverOptions& options, Shape shape) {
  SCOPED_TRACE(options.name + options.petsc_options +
               (shape == Shape::simplex ? " simplex " : " drop ") + std::to_string(D) + "D");
  const FreeCluster<D> cluster(shape);
  ASSERT_TRUE(cluster.resistance.translations_are_null());
  const auto solver = odpd::make_solver(options);
  solver->bind(cluster.resistance);
  const std::vector<double> balanced = cluster.central_load(4);
  // A bad guess full of null motions, and a load with a net force and torque beside the balanced one.
  const std::vector<double> noise = support::random_numbers(balanced.size(), 5);
  std::vector<double> x = noise, from_zero(balanced.size(), 0.0), unbalanced = balanced;
  const odpd::SolveReport report = solver->solve(balanced, x);
  ASSERT_TRUE(report.converged) << report.failure;
  EXPECT_EQ(report.problem, "R v = f, null space removed");
  EXPECT_LE(plain_residual(cluster, balanced, x), options.tolerance * (1.0 + 1e-6) + 1e-14);
  for (const double momentum : cluster.momenta(x))
    EXPECT_NEAR(momentum, 0.0, 1e-12 * support::norm(noise));
  // Null motions by hand: what a pure translation and rotation add to the load is left out.
  for (std::size_t n = 0; n < cluster.unwrapped.size(); ++n) {
    odpd::Vec<D> w{};
    w[0] = 3.0;
    const odpd::Vec<D> v = odpd::swing(w, cluster.unwrapped[n]) + support::uniform_vec<D>(2.0);
    for (std::size_t c = 0; c < D; ++c) unbalanced[n * D + c] += v.x[c];
  }
  const odpd::SolveReport second = solver->solve(unbalanced, from_zero);
  ASSERT_TRUE(second.converged) << second.failure;
  EXPECT_LT(contract::distance(from_zero, x), 1e3 * options.tolerance);
}

TEST(FreeCluster, EverySolverFindsTheAnswerOfLeastNorm) {
  odpd::set_threads(1, 0);
  std::vector<odpd::SolverOptions> all;
  for (const std::string& name : odpd::available_solvers()) {
    all.push_back({.name = name, .tolerance = 1e-9});
    if (name != "petsc") continue;
    for (const char* pc : {"-pc_type gamg", "-pc_type hypre", "-pc_type pbjacobi",
                           "-ksp_type preonly -pc_type cholesky"}) {
      all.push_back(all.back());
      all.back().petsc_options = pc;
    }
  }
  all.push_back({.name = "pcg", .tolerance = 1e-9, .preconditioner = "multilevel"});
  for (const odpd::SolverOptions& options : all)
    for (const Shape shape : {Shape::simplex, Shape::drop}) {
      // With just d links per particle block-Jacobi reflects the error for ever: D^-1 A has the eigenvalue 2.
      if (shape == Shape::simplex && options.name.starts_with("picard")) continue;
      expect_least_answer<2>(options, shape);
      expect_least_answer<3>(options, shape);
    }
}

// What the residual has along a null motion of many particles falls on one spring: without care the true residual misses the
// tolerance and refinement gains no more, for some loads.
TEST(FreeCluster, MayBeLarge) {
  const FreeCluster<2> cluster(Shape::large);
  for (const std::string& name : odpd::available_solvers()) {
    if (!odpd::solver_traits(name).assembles) continue;
    const auto solver = odpd::make_solver({.name = name, .tolerance = 1e-5});
    solver->bind(cluster.resistance);
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const std::vector<double> load = cluster.central_load(seed);
      std::vector<double> x(load.size(), 0.0);
      const odpd::SolveReport report = solver->solve(load, x);
      EXPECT_TRUE(report.converged) << name << ", load " << seed << ": " << report.failure;
      EXPECT_LE(plain_residual(cluster, load, x), 1e-5 * (1.0 + 1e-6));
    }
  }
}

}  // namespace
