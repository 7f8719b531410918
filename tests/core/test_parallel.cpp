#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <vector>

#include "odpd/core/parallel.h"
#include "odpd/core/random.h"

namespace {

// Numbers of many sizes and both signs: another order of adding shows in the last bits.
std::vector<double> rough_numbers(std::size_t n, std::uint64_t which) {
  const odpd::CounterRandom random(99, odpd::Stream::probe);
  std::vector<double> x(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto w = random.normals(which, 0, i, 0);
    x[i] = w[0] * std::exp(3.0 * w[2]);
  }
  return x;
}

class Parallel : public ::testing::Test {
 protected:
  void TearDown() override { odpd::set_threads(1, 0); }
};

TEST_F(Parallel, sums_have_the_same_bits_for_any_number_of_threads) {
  for (const std::size_t n : {0u, 1u, 1023u, 1024u, 1025u, 7168u, 8192u, 100003u}) {
    const std::vector<double> a = rough_numbers(n, 1), b = rough_numbers(n, 2);
    odpd::set_threads(1, 0);
    const double dot = odpd::fixed_dot(a, b), sum = odpd::fixed_sum(a), norm = odpd::fixed_norm(a);
    for (const int threads : {2, 3}) {
      odpd::set_threads(threads, 0);
      const auto same = [&](double x, double y) {
        EXPECT_EQ(std::bit_cast<std::uint64_t>(x), std::bit_cast<std::uint64_t>(y))
            << "n = " << n << ", threads = " << threads;
      };
      for (int repeat = 0; repeat < 3; ++repeat) {
        same(odpd::fixed_dot(a, b), dot);
        same(odpd::fixed_sum(a), sum);
        same(odpd::fixed_norm(a), norm);
      }
    }
  }
}

TEST_F(Parallel, sums_are_right) {
  for (const std::size_t n : {0u, 1u, 1025u, 100003u}) {
    const std::vector<double> a = rough_numbers(n, 1), b = rough_numbers(n, 2);
    long double dot = 0.0L, sum = 0.0L, square = 0.0L, size_dot = 0.0L, size_sum = 0.0L;
    for (std::size_t i = 0; i < n; ++i) {
      dot += static_cast<long double>(a[i]) * b[i];
      size_dot += std::abs(static_cast<long double>(a[i]) * b[i]);
      sum += a[i];
      size_sum += std::abs(static_cast<long double>(a[i]));
      square += static_cast<long double>(a[i]) * a[i];
    }
    // Rounding of blocked adding: at most (block length + number of blocks) units of the sum of
    // sizes.
    const double unit = 1200.0 * 0x1p-53;
    for (const int threads : {1, 2}) {
      odpd::set_threads(threads, 0);
      EXPECT_NEAR(odpd::fixed_dot(a, b), static_cast<double>(dot),
                  unit * static_cast<double>(size_dot));
      EXPECT_NEAR(odpd::fixed_sum(a), static_cast<double>(sum),
                  unit * static_cast<double>(size_sum));
      const double norm = static_cast<double>(std::sqrt(square));
      EXPECT_NEAR(odpd::fixed_norm(a), norm, unit * norm);
    }
  }
}

TEST_F(Parallel, a_loop_visits_each_index_once) {
  for (const int threads : {1, 2, 3}) {
    odpd::set_threads(threads, 0);
    for (const std::int64_t n : {0, 1, 512, 513, 10007}) {
      std::vector<int> visits(static_cast<std::size_t>(n));
      odpd::parallel_for(n, [&](std::int64_t i) { ++visits[static_cast<std::size_t>(i)]; });
      EXPECT_TRUE(std::all_of(visits.begin(), visits.end(), [](int v) { return v == 1; }))
          << "n = " << n << ", threads = " << threads;
    }
  }
}

#ifdef _OPENMP
TEST_F(Parallel, a_loop_runs_on_the_threads_asked_for) {
  odpd::set_threads(3, 0);
  EXPECT_EQ(odpd::threads(), 3);
  std::vector<int> who(3000);
  odpd::parallel_for(
      3000, [&](std::int64_t i) { who[static_cast<std::size_t>(i)] = omp_get_thread_num(); });
  EXPECT_EQ(*std::max_element(who.begin(), who.end()), 2);
}

TEST_F(Parallel, threads_are_chosen_by_the_number_of_particles) {
  const int most = omp_get_num_procs();
  odpd::set_threads(0, 100);
  EXPECT_EQ(odpd::threads(), 1);
  odpd::set_threads(0, 8000);
  EXPECT_EQ(odpd::threads(), std::min(2, most));
  odpd::set_threads(0, 1000000000);
  EXPECT_EQ(odpd::threads(), most);
}
#endif

}  // namespace
