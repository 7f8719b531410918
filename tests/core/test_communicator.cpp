#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "odpd/core/communicator.h"
#include "odpd/core/error.h"
#include "odpd/core/parallel.h"
#include "support/errors.h"
#include "support/thread_team.h"

namespace {

using odpd::Communicator;
using odpd::Share;
using support::ThreadTeam;

TEST(Communicator, AloneKeepsWhatItIsGiven) {
  const Communicator& one = Communicator::alone();
  EXPECT_EQ(one.size(), 1);
  EXPECT_EQ(one.sum(0.1), 0.1);
  EXPECT_EQ(one.largest(std::int64_t{-3}), -3);
  EXPECT_TRUE(one.any(true));
  EXPECT_FALSE(one.all(false));
  std::vector<double> x{1.0, 2.0};
  one.sum(std::span(x));
  EXPECT_EQ(x, (std::vector<double>{1.0, 2.0}));
  EXPECT_THROW(one.together([] { throw odpd::ConfigError("no"); }), odpd::ConfigError);
}

// Numbers whose sum depends on the order: all ranks must get the same bits, those of the order of the ranks.
TEST(Communicator, AllRanksGetTheSameBits) {
  const std::vector<double> value{1.0, 1e-16, 1e-16, 1.0 / 3.0};
  double expected = value[0];
  for (std::size_t r = 1; r < value.size(); ++r) expected += value[r];
  ASSERT_NE(expected, value[3] + value[2] + value[1] + value[0]);
  for (int round = 0; round < 50; ++round)
    ThreadTeam::run(4, [&](const Communicator& ranks) {
      const double mine = value[static_cast<std::size_t>(ranks.rank())];
      EXPECT_EQ(ranks.sum(mine), expected);
      std::vector<double> several{mine, -mine, 1.0};
      ranks.sum(std::span(several));
      EXPECT_EQ(several, (std::vector<double>{expected, -expected, 4.0}));
      EXPECT_EQ(ranks.smallest(mine), 1e-16);
      EXPECT_EQ(ranks.largest(mine), 1.0);
      EXPECT_EQ(ranks.smallest(std::int64_t{ranks.rank()} - 1), -1);
      EXPECT_EQ(ranks.sum(std::int64_t{ranks.rank()}), 6);
    });
}

TEST(Communicator, DecidesForAll) {
  ThreadTeam::run(3, [](const Communicator& ranks) {
    EXPECT_TRUE(ranks.any(ranks.rank() == 2));
    EXPECT_FALSE(ranks.any(false));
    EXPECT_FALSE(ranks.all(ranks.rank() != 1));
    EXPECT_TRUE(ranks.all(true));
  });
}

// The first rank that fails speaks for all, whichever is the first in time; afterwards they go on together.
TEST(Communicator, AnErrorOnOneRankReachesAll) {
  ThreadTeam::run(4, [](const Communicator& ranks) {
    const auto fail = [&](int from, const auto& error) {
      ranks.together([&] {
        if (ranks.rank() >= from) throw error;
      });
    };
    const char *first = "of rank 1", *all = "of all";
    const std::string own = "of rank " + std::to_string(ranks.rank());
    support::expect_error<odpd::BlowUpError>([&] { fail(1, odpd::BlowUpError(own, ranks.rank())); },
                                             {first});
    try {
      fail(2, odpd::BondTooLongError(own, 7 + ranks.rank()));
      ADD_FAILURE() << "nothing was thrown";
    } catch (const odpd::BondTooLongError& e) {
      EXPECT_EQ(e.particle(), 9);
    }
    try {
      fail(3, odpd::SolverError(own, odpd::SolverError::Cause::singular));
      ADD_FAILURE() << "nothing was thrown";
    } catch (const odpd::BlowUpError&) {
      ADD_FAILURE() << "of another type";
    } catch (const odpd::SolverError& e) {
      EXPECT_EQ(e.cause(), odpd::SolverError::Cause::singular);
      EXPECT_EQ(std::string(e.what()), "of rank 3");
    }
    support::expect_error<odpd::ConfigError>([&] { fail(0, odpd::ConfigError(all)); }, {all});
    support::expect_error<odpd::IoError>([&] { fail(3, odpd::IoError(all)); }, {all});
    EXPECT_THROW(fail(1, std::bad_alloc()), std::bad_alloc);
    support::expect_error<std::runtime_error>([&] { fail(1, std::logic_error(own)); }, {first});
    ranks.together([] {});
    EXPECT_EQ(ranks.sum(1.0), 4.0);
  });
}

TEST(Communicator, ATeamDoesNotWaitForEver) {
  const auto skips = [](const Communicator& ranks) {
    if (ranks.rank() != 1) ranks.sum(1.0);
  };
  EXPECT_THROW(ThreadTeam::run(3, skips), support::RanksDisagree);
  const auto differs = [](const Communicator& ranks) {
    std::vector<double> x(ranks.rank() == 0 ? 2 : 3, 1.0);
    ranks.sum(std::span(x));
  };
  EXPECT_THROW(ThreadTeam::run(2, differs), support::RanksDisagree);
  const auto strays = [](const Communicator& ranks) {
    if (ranks.rank() == 1) throw odpd::ConfigError("stray");
    ranks.sum(1.0);
  };
  EXPECT_THROW(ThreadTeam::run(2, strays), odpd::ConfigError);
}

TEST(Share, EveryEntryHasOneOwner) {
  for (const int size : {1, 2, 3, 4})
    for (const std::int64_t n : {0, 1, 3, 1000}) {
      std::vector<double> x(static_cast<std::size_t>(2 * n));
      for (std::size_t k = 0; k < x.size(); ++k) x[k] = std::sin(1.0 + static_cast<double>(k));
      ThreadTeam::run(size, [&](const Communicator& ranks) {
        const Share share = Share::of(ranks, n);
        std::int64_t owned = 0;
        for (std::int64_t k = 0; k < n; ++k) owned += share.owns(k) ? 1 : 0;
        EXPECT_EQ(owned, share.end(n) - share.first);
        EXPECT_EQ(share.part(std::span(x), 2).size(), static_cast<std::size_t>(2 * owned));
        EXPECT_EQ(ranks.sum(owned), n);
        EXPECT_NEAR(share.dot(x, x, 2), odpd::fixed_dot(x, x), 1e-13 * (1.0 + share.dot(x, x, 2)));
        EXPECT_NEAR(share.sum(x, 2), odpd::fixed_sum(x), 1e-12);
      });
      EXPECT_EQ(Share{}.dot(x, x, 2), odpd::fixed_dot(x, x));
    }
}

}  // namespace
