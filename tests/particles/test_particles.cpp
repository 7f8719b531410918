#include <gtest/gtest.h>

#include <atomic>

#include "odpd/core/error.h"
#include "odpd/particles/particles.h"
#include "support/dimensions.h"
#include "support/errors.h"
#include "support/memory_archive.h"
#include "support/points.h"
#include "support/thread_team.h"

namespace {

using odpd::Particles;
using odpd::Vec;
using support::MemoryArchive;

// Every field of particle i is a function of its identity.
template <int D>
void fill(Particles<D>& particles, std::size_t count) {
  for (std::size_t k = 0; k < count; ++k) {
    particles.add(support::uniform_vec<D>(0.1 * static_cast<double>(k) + 1e-17),
                  static_cast<std::int32_t>(k % 3),
                  odpd::Group::of_code(static_cast<std::int64_t>(k % 4)));
    particles.velocity[k] = support::uniform_vec<D>(1.0 / (1.0 + static_cast<double>(k)));
    particles.image[k].fill(static_cast<std::int32_t>(k) - 5);
  }
}

template <int D>
void expect_particle(const Particles<D>& p, std::size_t i, std::size_t k) {
  EXPECT_EQ(p.id[i], static_cast<std::int64_t>(k));
  EXPECT_EQ(p.position[i], support::uniform_vec<D>(0.1 * static_cast<double>(k) + 1e-17));
  EXPECT_EQ(p.velocity[i], support::uniform_vec<D>(1.0 / (1.0 + static_cast<double>(k))));
  for (const std::int32_t n : p.image[i]) EXPECT_EQ(n, static_cast<std::int32_t>(k) - 5);
  EXPECT_EQ(p.species[i], static_cast<std::int32_t>(k % 3));
  EXPECT_EQ(p.group[i].code(), static_cast<std::int32_t>(k % 4));
}

template <class T>
class ParticlesTest : public ::testing::Test {};
TYPED_TEST_SUITE(ParticlesTest, support::Dimensions);

TYPED_TEST(ParticlesTest, NewOnesAreNumberedAndAtRest) {
  constexpr int D = TypeParam::D;
  Particles<D> particles;
  EXPECT_EQ(particles.size(), 0);
  particles.add(support::uniform_vec<D>(2.0), 1);
  particles.add(support::uniform_vec<D>(3.0), 0, odpd::Group::wall(1));
  EXPECT_EQ(particles.size(), 2);
  EXPECT_EQ(particles.id, (std::vector<std::int64_t>{0, 1}));
  EXPECT_EQ(particles.velocity[1], Vec<D>{});
  EXPECT_EQ(particles.image[1], (typename Particles<D>::Image{}));
  EXPECT_TRUE(particles.is_free(0));
  EXPECT_FALSE(particles.is_free(1));
  EXPECT_EQ(particles.free_count(), 1);
}

TYPED_TEST(ParticlesTest, ReorderMovesAllFieldsTogether) {
  constexpr int D = TypeParam::D;
  Particles<D> particles;
  fill(particles, 57);
  const auto order = support::random_order(57, 4);
  particles.reorder(order);
  for (std::size_t i = 0; i < 57; ++i) {
    expect_particle(particles, i, static_cast<std::size_t>(order[i]));
  }
  particles.reorder(support::random_order(57, 5));
  const auto index = particles.index_of_id();
  for (std::size_t k = 0; k < 57; ++k) {
    expect_particle(particles, static_cast<std::size_t>(index[k]), k);
  }
  EXPECT_EQ(particles.free_count(), 15);
}

TYPED_TEST(ParticlesTest, SaveAndLoadKeepEveryBit) {
  constexpr int D = TypeParam::D;
  Particles<D> particles;
  fill(particles, 31);
  particles.reorder(support::random_order(31, 9));
  MemoryArchive archive;
  particles.save(archive);
  Particles<D> copy;
  fill(copy, 3);
  copy.load(archive);
  EXPECT_EQ(copy.position, particles.position);
  EXPECT_EQ(copy.image, particles.image);
  EXPECT_EQ(copy.velocity, particles.velocity);
  EXPECT_EQ(copy.id, particles.id);
  EXPECT_EQ(copy.species, particles.species);
  EXPECT_EQ(copy.group, particles.group);
}

TYPED_TEST(ParticlesTest, RefusesADamagedState) {
  constexpr int D = TypeParam::D;
  Particles<D> particles;
  fill(particles, 6);
  MemoryArchive whole;
  particles.save(whole);
  const auto load = [](const MemoryArchive& archive) {
    Particles<D> copy;
    copy.load(archive);
  };
  EXPECT_NO_THROW(load(whole));
  for (const auto& [name, values] : whole.doubles) {
    for (const std::size_t left : {values.size() - 1, values.size() - D}) {
      MemoryArchive damaged = whole;
      damaged.doubles[name].resize(left);
      support::expect_error<odpd::IoError>([&] { load(damaged); }, {"damaged"});
    }
  }
  for (const auto& [name, values] : whole.integers) {
    MemoryArchive damaged = whole;
    damaged.integers[name].resize(values.size() - 1);
    support::expect_error<odpd::IoError>([&] { load(damaged); }, {"damaged"});
    damaged.integers.erase(name);
    EXPECT_THROW(load(damaged), odpd::IoError) << "without " << name;
  }
}

// What others keep per particle moves with it, is asked for by name, and goes into checkpoints.
TYPED_TEST(ParticlesTest, CarryColumnsOfOthers) {
  constexpr int D = TypeParam::D;
  Particles<D> particles;
  fill(particles, 5);
  const Particles<D>& seen = particles;
  std::vector<Vec<D>>& kept = seen.carry("kept");
  EXPECT_EQ(kept, std::vector<Vec<D>>(5));
  for (std::size_t i = 0; i < kept.size(); ++i) kept[i] = particles.velocity[i];
  particles.reorder({3, 1, 4, 0, 2});
  EXPECT_EQ(kept, particles.velocity);
  EXPECT_EQ(&seen.carry("kept"), &kept);
  seen.carry("other");
  fill(particles, 1);
  EXPECT_EQ(kept.size(), 6U);
  EXPECT_EQ(seen.carry("other").size(), 6U);
  MemoryArchive archive;
  particles.save(archive);
  Particles<D> copy;
  copy.carry("kept");
  copy.load(archive);
  EXPECT_EQ(copy.carry("kept"), kept);
  Particles<D> without;
  without.carry("never kept");
  EXPECT_THROW(without.load(archive), odpd::IoError);
}

// Whoever asks for spins at first without inertia can still ask for them with inertia.
TYPED_TEST(ParticlesTest, SpinsGetTheirEndOfStepWhenItIsAskedForLater) {
  constexpr int D = TypeParam::D;
  Particles<D> particles;
  fill(particles, 4);
  particles.carry_spins(false);
  EXPECT_TRUE(particles.end_spin.empty());
  particles.spin[2] = support::uniform_vec<D>(0.5);
  particles.carry_spins(true);
  EXPECT_EQ(particles.end_spin.size(), 4u);
  EXPECT_EQ(particles.spin[2], support::uniform_vec<D>(0.5));
}

TYPED_TEST(ParticlesTest, EachHasOneOwner) {
  constexpr int D = TypeParam::D;
  std::atomic<int> found{0};
  support::ThreadTeam::run(3, [&](const odpd::Communicator& ranks) {
    Particles<D> particles;
    fill(particles, 10);
    particles.reorder({3, 1, 4, 0, 2, 9, 8, 7, 6, 5});
    const std::int64_t free = particles.free_count();
    particles.share_among(ranks);
    EXPECT_EQ(particles.free_count(), free);
    std::int64_t before = -1;
    for (const std::int32_t i : particles.owned_by_identity()) {
      EXPECT_TRUE(particles.owned().owns(std::int64_t{i}));
      EXPECT_GT(particles.id[static_cast<std::size_t>(i)], before);
      before = particles.id[static_cast<std::size_t>(i)];
      ++found;
    }
  });
  EXPECT_EQ(found, 10);
}

}  // namespace
