#include <gtest/gtest.h>

#include "odpd/operator/dof_map.h"
#include "support/dimensions.h"
#include "support/points.h"
#include "support/simplex.h"

namespace {

using odpd::DofMap;
using odpd::Vec;

template <class T>
class DofMapTest : public ::testing::Test {};
TYPED_TEST_SUITE(DofMapTest, support::Dimensions);

// Free, known, free, known, known, free.
template <int D>
void fill(odpd::Particles<D>& particles) {
  for (const int code : {0, 1, 0, 2, 1, 0}) particles.add(Vec<D>{}, 0, odpd::Group::of_code(code));
}

TYPED_TEST(DofMapTest, NodesAreTheFreeParticlesInOrder) {
  constexpr int D = TypeParam::D;
  odpd::Particles<D> particles;
  fill(particles);
  const DofMap<D> dofs(particles);
  EXPECT_EQ(dofs.nodes(), 3);
  EXPECT_EQ(dofs.particles(), 6);
  EXPECT_EQ(dofs.unknowns(), 3 * D);
  const std::vector<std::int32_t> node{0, -1, 1, -1, -1, 2};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(dofs.mobile_of(i), node[i]);
  const std::vector<std::int32_t> particle{0, 2, 5};
  for (std::size_t n = 0; n < 3; ++n) EXPECT_EQ(dofs.particle_of(n), particle[n]);
}

TYPED_TEST(DofMapTest, GatherIsTheTransposeOfScatter) {
  constexpr int D = TypeParam::D;
  odpd::Particles<D> particles;
  fill(particles);
  const DofMap<D> dofs(particles);
  const auto force = support::random_vectors<D>(6, 1);
  const auto known = support::random_vectors<D>(6, 2);
  std::vector<double> q;
  dofs.gather({}, force, q);
  ASSERT_EQ(q.size(), 3u * D);
  for (std::size_t c = 0; c < D; ++c) {
    EXPECT_EQ(q[c], force[0].x[c]);
    EXPECT_EQ(q[D + c], force[2].x[c]);
    EXPECT_EQ(q[2 * D + c], force[5].x[c]);
  }
  const auto unknowns = support::random_numbers(3 * D, 3);
  std::vector<Vec<D>> velocity;
  dofs.scatter({}, unknowns, known, velocity);
  ASSERT_EQ(velocity.size(), 6u);
  for (const std::size_t i : {1u, 3u, 4u}) EXPECT_EQ(velocity[i], known[i]);
  std::vector<double> back;
  dofs.gather({}, velocity, back);
  EXPECT_EQ(back, unknowns);
  // f . P q = P^T f . q
  const std::vector<Vec<D>> rest(6);
  dofs.scatter({}, unknowns, rest, velocity);
  double left = 0.0, right = 0.0;
  for (std::size_t i = 0; i < 6; ++i) left += dot(force[i], velocity[i]);
  for (std::size_t k = 0; k < q.size(); ++k) right += q[k] * unknowns[k];
  EXPECT_NEAR(left, right, 1e-13);
}

// Momenta per mass of rigid motions give these motions back; what cannot move, a rod's spin about its line, is left out.
TYPED_TEST(DofMapTest, InertiaDividesOutOfMomentaOfBodies) {
  constexpr int D = TypeParam::D;
  const odpd::Box<D> box{support::uniform_vec<D>(10.0), {}};
  odpd::Particles<D> particles;
  std::vector<Vec<D>> arms;
  particles.add(Vec<D>{}, 0);
  arms.push_back(Vec<D>{});
  for (const auto& body : {support::rod_body<D>(), support::simplex_body<D>()}) {
    particles.add_body(body, box, 0);
    arms.insert(arms.end(), body.frame.begin(), body.frame.end());
  }
  const DofMap<D> dofs(particles);
  std::vector<double> q = support::random_numbers(static_cast<std::size_t>(dofs.unknowns()), 6), l;
  std::vector<Vec<D>> v;
  dofs.scatter(arms, q, std::vector<Vec<D>>(arms.size()), v);
  dofs.gather(arms, v, l);
  dofs.divide_by_inertia(arms, l);
  const Vec<D> u = (1.0 / norm(arms[1])) * arms[1];
  double spin = 0.0;
  for (std::size_t c = 0; c < D && D == 3; ++c) spin += u.x[c] * q[c];
  for (std::size_t c = 0; c < D && D == 3; ++c) q[c] -= spin * u.x[c];
  for (std::size_t b = 0; b < 2 && D == 2; ++b) q[b * D + 1] = 0.0;  // unused
  for (std::size_t k = 0; k < q.size(); ++k) EXPECT_NEAR(l[k], q[k], 1e-13) << k;
}

// A field of one number per particle decides for itself who is known: here a wall particle without a temperature of its own
// and a fluid particle with one.
TEST(NodeMap, KnownIsWhatTheFieldSays) {
  const odpd::NodeMap map(std::vector<char>{0, 1, 1, 0, 0}, 1);
  EXPECT_EQ(map.block_size(), 1);
  EXPECT_EQ(map.unknowns(), 3);
  EXPECT_EQ(map.particles(), 5);
  const std::vector<std::int32_t> node{0, -1, -1, 1, 2}, particle{0, 3, 4};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(map.node_of(i), node[i]);
  for (std::size_t n = 0; n < 3; ++n) EXPECT_EQ(map.particle_of(n), particle[n]);
}

TEST(NodeMap, GatherIsTheTransposeOfScatter) {
  for (const int block : {1, 3, 6}) {
    const auto b = static_cast<std::size_t>(block);
    const odpd::NodeMap map(std::vector<char>{1, 0, 0, 1, 0}, block);
    const auto values = support::random_numbers(5 * b, 1), q = support::random_numbers(3 * b, 2);
    std::vector<double> gathered(3 * b), scattered(5 * b, 0.0);
    map.gather(values, gathered);
    map.scatter(q, scattered);
    double left = 0.0, right = 0.0;
    for (std::size_t k = 0; k < gathered.size(); ++k) left += gathered[k] * q[k];
    for (std::size_t k = 0; k < values.size(); ++k) right += values[k] * scattered[k];
    EXPECT_NEAR(left, right, 1e-13);
    for (std::size_t c = 0; c < b; ++c) {
      EXPECT_EQ(gathered[b + c], values[2 * b + c]);
      EXPECT_EQ(scattered[4 * b + c], q[2 * b + c]);
      EXPECT_EQ(scattered[3 * b + c], 0.0) << "known ones keep theirs";
    }
  }
}

}  // namespace
