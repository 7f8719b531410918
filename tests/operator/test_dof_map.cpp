#include <gtest/gtest.h>

#include "odpd/core/parallel.h"
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

// Forty free bodies of three to nine constituents, three of known motion, free particles and a wall, shuffled in memory.
template <int D>
struct BodyCrowd {
  BodyCrowd() {
    particles.walls = 1;
    odpd::Box<D> box{support::uniform_vec<D>(20.0), {}};
    box.periodic.fill(true);
    for (std::size_t b = 0; b < 43; ++b) {
      odpd::RigidBody<D> body;
      body.known = b >= 40;
      body.frame = support::random_vectors<D>(3 + b % 7, 50 + b);
      Vec<D> mean{};
      for (const Vec<D>& r : body.frame) mean += (1.0 / static_cast<double>(body.frame.size())) * r;
      for (Vec<D>& r : body.frame) r -= mean;
      particles.add_body(body, box, 0);
      for (std::size_t k = 0; k < 4; ++k)
        particles.add(Vec<D>{}, 0, k == 0 ? odpd::Group::wall(0) : odpd::Group());
    }
    const auto n = static_cast<std::size_t>(particles.size());
    particles.reorder(support::random_order(n, 5));
    arms.resize(n);
    const auto index_of = particles.index_of_id();
    for (const auto& body : particles.bodies)
      for (std::size_t k = 0; k < body.frame.size(); ++k)
        arms[static_cast<std::size_t>(index_of[static_cast<std::size_t>(body.members[k])])] =
            body.frame[k];
  }
  odpd::Particles<D> particles;
  std::vector<Vec<D>> arms;
};

TYPED_TEST(DofMapTest, ConstituentsAreTheMembersWhereverTheyLie) {
  constexpr int D = TypeParam::D;
  const BodyCrowd<D> crowd;
  const DofMap<D> dofs(crowd.particles);
  EXPECT_EQ(dofs.bodies(), 40);
  for (std::size_t b = 0; b < 43; ++b) {
    std::vector<std::int64_t> members;
    for (const std::int32_t p : dofs.constituents(b))
      members.push_back(crowd.particles.id[static_cast<std::size_t>(p)]);
    EXPECT_EQ(members, crowd.particles.bodies[b].members);
  }
}

// f . P q = P^T f . q, and P^T P by itself is what both make of it.
TYPED_TEST(DofMapTest, ManyBodiesGatherAsTheTransposeOfTheirScatter) {
  constexpr int D = TypeParam::D;
  const BodyCrowd<D> crowd;
  const DofMap<D> dofs(crowd.particles);
  const std::size_t n = crowd.arms.size();
  const auto force = support::random_vectors<D>(n, 1), known = support::random_vectors<D>(n, 2);
  auto q = support::random_numbers(static_cast<std::size_t>(dofs.unknowns()), 3);
  for (std::size_t b = 0; b < 40; ++b)
    for (std::size_t c = odpd::rotation_components<D>; c < D; ++c) q[b * D + c] = 0.0;
  std::vector<Vec<D>> velocity;
  dofs.scatter(crowd.arms, q, known, velocity);
  for (std::size_t i = 0; i < n; ++i) {
    if (crowd.particles.is_known(i)) {
      EXPECT_EQ(velocity[i], known[i]);
    }
  }
  dofs.scatter(crowd.arms, q, std::vector<Vec<D>>(n), velocity);
  std::vector<double> load;
  dofs.gather(crowd.arms, force, load);
  double left = 0.0, right = 0.0, size = 0.0;
  for (std::size_t i = 0; i < n; ++i) left += dot(force[i], velocity[i]);
  for (std::size_t k = 0; k < q.size(); ++k) {
    right += load[k] * q[k];
    size += std::abs(load[k] * q[k]);
  }
  EXPECT_NEAR(left, right, 1e-14 * size);

  std::vector<double> momentum = q, gathered;
  dofs.times_inertia(crowd.arms, momentum);
  dofs.gather(crowd.arms, velocity, gathered);
  EXPECT_EQ(momentum, gathered);
  dofs.divide_by_inertia(crowd.arms, momentum);
  for (std::size_t k = 0; k < q.size(); ++k) EXPECT_NEAR(momentum[k], q[k], 1e-11);
}

TYPED_TEST(DofMapTest, ManyBodiesHaveTheSameBitsOnAnyThreadCount) {
  constexpr int D = TypeParam::D;
  const BodyCrowd<D> crowd;
  const DofMap<D> dofs(crowd.particles);
  const std::size_t n = crowd.arms.size();
  const auto force = support::random_vectors<D>(n, 1);
  const int before = odpd::threads();
  std::vector<std::vector<double>> results;
  for (const int count : {1, 2, 4}) {
    odpd::set_threads(count, 0);
    std::vector<double> q, momentum;
    std::vector<Vec<D>> velocity;
    dofs.gather(crowd.arms, force, q);
    dofs.scatter(crowd.arms, q, force, velocity);
    momentum = q;
    dofs.times_inertia(crowd.arms, momentum);
    q.insert(q.end(), momentum.begin(), momentum.end());
    dofs.divide_by_inertia(crowd.arms, momentum);
    q.insert(q.end(), momentum.begin(), momentum.end());
    for (const Vec<D>& v : velocity) q.insert(q.end(), v.x.begin(), v.x.end());
    results.push_back(q);
  }
  odpd::set_threads(before, 0);
  EXPECT_EQ(results[0], results[1]);
  EXPECT_EQ(results[0], results[2]);
}

// A body without a moment of inertia is an error on any thread, told by the one that lies first.
TEST(ForEachBody, ThrowsWhatTheFirstThrows) {
  const int before = odpd::threads();
  for (const int count : {1, 2}) {
    odpd::set_threads(count, 0);
    std::vector<int> done(100, 0);
    std::string what;
    try {
      odpd::for_each_body<2>(done.size(), [&](std::size_t b, auto&) {
        if (b == 20 || b == 90) throw std::runtime_error(std::to_string(b));
        done[b] = 1;
      });
    } catch (const std::runtime_error& e) {
      what = e.what();
    }
    EXPECT_EQ(what, "20");
    for (const std::size_t b : {0, 19, 32, 89, 99}) EXPECT_EQ(done[b], 1) << b;
    for (const std::size_t b : {20, 21, 90, 91}) EXPECT_EQ(done[b], 0) << b;
  }
  odpd::set_threads(before, 0);
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
