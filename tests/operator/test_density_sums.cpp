// Forces, Laplacian and virial of a model with densities against differences of its energy, which comes from the definition.
#include <gtest/gtest.h>

#include <functional>

#include "odpd/core/parallel.h"
#include "odpd/operator/edge_sums.h"
#include "support/density_models.h"
#include "support/dimensions.h"

namespace {

using odpd::Vec;
using support::Crowd;
using support::ToyModel;

// Of f at 0 by five points, with errors of the fourth power of the step.
struct Slopes {
  double first, second;
};
Slopes slopes(double h, const std::function<double(double)>& f) {
  const double a = f(-2.0 * h), b = f(-h), c = f(0.0), d = f(h), e = f(2.0 * h);
  return {(a - 8.0 * b + 8.0 * d - e) / (12.0 * h),
          (-a + 16.0 * b - 30.0 * c + 16.0 * d - e) / (12.0 * h * h)};
}

// Some pair of particle i is so near a kink, or to r = 0, that differences would see it.
template <int D>
bool is_near_a_kink(const Crowd<D>& crowd, const odpd::PairModel<D>& model, std::size_t i,
                    double step) {
  for (std::size_t j = 0; j < crowd.particles.position.size(); ++j) {
    if (j != i && crowd.distance(i, j) < 0.1) return true;
    for (const double r : model.kinks(site_of(crowd.particles, i), site_of(crowd.particles, j)))
      if (j != i && std::abs(crowd.distance(i, j) - r) < 3.0 * step) return true;
  }
  return false;
}

template <class T>
class DensitySumsTest : public ::testing::Test {
 protected:
  /// check(model, step, small) of every one.
  template <class Check>
  static void for_each_model(const Check& check) {
    for (const auto& entry : support::density_models<T::D>()) {
      SCOPED_TRACE(entry.name);
      check(*entry.model, entry.step, entry.small);
    }
  }
};
TYPED_TEST_SUITE(DensitySumsTest, support::Dimensions);

// Free particles near walls and bodies among them, whose densities have parts that no edge has.
TYPED_TEST(DensitySumsTest, ForceAndLaplacianAreDerivativesOfTheEnergy) {
  constexpr int D = TypeParam::D;
  this->for_each_model([](const odpd::PairModel<D>& model, double step, double small) {
    Crowd<D> crowd(D == 2 ? 60 : 110);
    crowd.connect(model);
    std::vector<Vec<D>> force(crowd.particles.position.size());
    std::vector<double> laplacian(force.size(), 0.0);
    odpd::add_conservative_forces(crowd.network, force);
    odpd::add_laplacian(crowd.network, laplacian);
    double largest_force = 0.0, largest_laplacian = 0.0;
    for (std::size_t i = 0; i < force.size(); ++i) {
      if (!crowd.particles.is_free(i)) continue;
      largest_force = std::max(largest_force, norm(force[i]));
      largest_laplacian = std::max(largest_laplacian, std::abs(laplacian[i]));
    }
    int beside_walls = 0, tried = 0;
    for (std::size_t i = 0; i < force.size(); ++i) {
      Vec<D>& r = crowd.particles.position[i];
      const Vec<D> start = r;
      const bool near = start[0] < 1.4;
      if (!crowd.particles.is_free(i) || (!near && i % 3 != 0) || tried > 20) continue;
      if (small < step && is_near_a_kink(crowd, model, i, step)) continue;
      ++tried;
      beside_walls += near ? 1 : 0;
      double curvature = 0.0;
      for (int c = 0; c < D; ++c) {
        const Slopes s = slopes(step, [&](double x) {
          r = start;
          r[c] += x;
          crowd.box.wrap(r);
          return crowd.energy(model);
        });
        EXPECT_NEAR(force[i][c], -s.first, 1e-7 * largest_force);
        curvature += s.second;
      }
      r = start;
      EXPECT_NEAR(laplacian[i], curvature, 1e-7 * largest_laplacian);
    }
    EXPECT_GT(beside_walls, 4);
    EXPECT_GT(tried, 10);
  });
}

// Moved and turned as a whole.
TYPED_TEST(DensitySumsTest, ForceAndTorqueOnABodyAreDerivativesOfTheEnergy) {
  constexpr int D = TypeParam::D;
  this->for_each_model([](const odpd::PairModel<D>& model, double, double small) {
    Crowd<D> crowd(D == 2 ? 60 : 110);
    crowd.connect(model);
    std::vector<Vec<D>> force(crowd.particles.position.size());
    odpd::add_conservative_forces(crowd.network, force);
    odpd::RigidBody<D>& body = crowd.particles.bodies[0];
    const odpd::RigidPose<D> start = body.pose;
    const auto index = crowd.particles.index_of_id();
    odpd::RigidLoad<D> load;
    for (std::size_t k = 0; k < body.members.size(); ++k) {
      const auto p = static_cast<std::size_t>(index[static_cast<std::size_t>(body.members[k])]);
      load.force += force[p];
      load.torque += torque(start.orientation.turn(body.frame[k]), force[p]);
    }
    const auto energy = [&](const odpd::RigidMotion<D>& motion) {
      odpd::RigidPose<D> pose = start;
      pose.advance(motion, 1.0, crowd.box);
      for (std::size_t k = 0; k < body.members.size(); ++k) {
        const auto p = static_cast<std::size_t>(index[static_cast<std::size_t>(body.members[k])]);
        place_constituent(body, pose, k, crowd.box, crowd.particles.position[p],
                          crowd.particles.image[p]);
      }
      return crowd.energy(model);
    };
    const double scale = norm(load.force);
    ASSERT_GT(scale, 1.0);
    for (int c = 0; c < D; ++c) {
      odpd::RigidMotion<D> motion;
      EXPECT_NEAR(load.force[c],
                  -slopes(small,
                          [&](double x) {
                            motion.velocity[c] = x;
                            return energy(motion);
                          })
                       .first,
                  1e-7 * scale);
    }
    for (int c = 0; c < odpd::rotation_components<D>; ++c) {
      odpd::RigidMotion<D> motion;
      EXPECT_NEAR(load.torque[c],
                  -slopes(small,
                          [&](double x) {
                            motion.angular[c] = x;
                            return energy(motion);
                          })
                       .first,
                  1e-7 * scale);
    }
  });
}

// The box and all places scaled, bodies by their centres: d E/d ln L = - sum of r f_c.
TYPED_TEST(DensitySumsTest, VirialIsTheDerivativeByTheVolume) {
  constexpr int D = TypeParam::D;
  this->for_each_model([](const odpd::PairModel<D>& model, double, double small) {
    Crowd<D> crowd(D == 2 ? 60 : 110, 3.2, true);
    crowd.connect(model);
    double virial = 0.0;
    for (std::size_t k = 0; k < crowd.network.f_c.size(); ++k)
      virial += crowd.network.r[k] * crowd.network.f_c[k];
    const auto start = crowd.particles.position;
    const Vec<D> size = crowd.box.size;
    const double slope = slopes(small, [&](double x) {
                           crowd.box.size = (1.0 + x) * size;
                           for (std::size_t i = 0; i < start.size(); ++i)
                             crowd.particles.position[i] = (1.0 + x) * start[i];
                           return crowd.energy(model);
                         }).first;
    EXPECT_NEAR(virial, -slope, 1e-7 * std::abs(virial));
  });
}

TYPED_TEST(DensitySumsTest, HaveTheSameBitsOnAnyThreadCount) {
  constexpr int D = TypeParam::D;
  Crowd<D> crowd(D == 2 ? 900 : 1400, D == 2 ? 12.0 : 6.0);
  crowd.connect(ToyModel<D>({.c = 0.8, .pair = 3.0}));
  std::vector<double> first;
  for (const int threads : {1, 2, 4}) {
    odpd::set_threads(threads, 0);
    std::vector<double> laplacian(crowd.particles.position.size(), 0.0);
    odpd::add_laplacian(crowd.network, laplacian);
    odpd::set_threads(1, 0);
    if (threads == 1) first = laplacian;
    EXPECT_EQ(laplacian, first);
  }
}

}  // namespace
