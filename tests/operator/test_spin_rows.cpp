// The packed rows of spins with those of velocities are A to single precision, on the kernels of the process's path.
#include <gtest/gtest.h>

#include "odpd/core/parallel.h"
#include "odpd/operator/spin_rows.h"
#include "support/dimensions.h"
#include "support/spin_fluid.h"

namespace {

template <int D>
struct PackedSpinFluid {
  explicit PackedSpinFluid(const support::SpinFluidSpec& spec) : toy(spec) {
    rows.pack(toy.velocities());
    spins.pack(toy.resistance, rows);
  }
  /// Where an unknown's number stands in a packed vector.
  std::int64_t at(std::int64_t node, std::int64_t c) const {
    const std::int64_t in_front = toy.resistance.spins();
    const std::int64_t place =
        node < in_front ? spins.first_place() + node
                        : rows.place_of_node()[static_cast<std::size_t>(node - in_front)];
    return place * odpd::SlicedRows<D>::stride + c;
  }
  std::vector<double> product(const std::vector<double>& x, double& work) const {
    odpd::FloatArray in, out;
    for (odpd::FloatArray* v : {&in, &out}) {
      v->resize((rows.places() + spins.places()) * odpd::SlicedRows<D>::stride);
      v->fill(0.0F);
    }
    const std::int64_t n = toy.system().nodes();
    for (std::int64_t k = 0; k < n * D; ++k)
      in.data()[at(k / D, k % D)] = static_cast<float>(x[static_cast<std::size_t>(k)]);
    work = 0.0;
    for (std::int64_t first = 0; first < rows.places(); first += 1024) {
      const std::int64_t last = std::min(first + 1024, rows.places());
      work += rows.product(in.data(), out.data(), first, last);
      work += spins.product(in.data(), out.data(), first, last);
    }
    for (std::int64_t k = toy.resistance.spins(); k < spins.places(); ++k)
      for (std::int64_t c = 0; c < D; ++c)
        EXPECT_EQ(out.data()[(spins.first_place() + k) * odpd::SlicedRows<D>::stride + c], 0.0F);
    std::vector<double> y(x.size());
    for (std::int64_t k = 0; k < n * D; ++k)
      y[static_cast<std::size_t>(k)] = static_cast<double>(out.data()[at(k / D, k % D)]);
    return y;
  }

  support::SpinFluid<D> toy;
  odpd::SlicedRows<D> rows;
  odpd::SpinRows<D> spins;
};

template <class T>
class SpinRows : public ::testing::Test {};
TYPED_TEST_SUITE(SpinRows, support::Dimensions);

TYPED_TEST(SpinRows, AreTheOperatorToSinglePrecision) {
  constexpr int D = TypeParam::D;
  for (const support::SpinFluidSpec& spec :
       {support::SpinFluidSpec{.count = 1500, .radius_spread = 1.0},
        support::SpinFluidSpec{.count = 1500, .walls = true, .spinning = 0.5, .radius_spread = 1.0},
        support::SpinFluidSpec{.count = 1500, .spinning = 0.02, .inertia = 2.0},
        support::SpinFluidSpec{.count = 777, .walls = true, .inertia = 0.7}}) {
    const PackedSpinFluid<D> p(spec);
    ASSERT_GT(p.toy.resistance.spins(), 0);
    const auto x = support::random_numbers(static_cast<std::size_t>(p.toy.system().size()), 4);
    std::vector<double> exact(x.size());
    p.toy.system().apply(x, exact);
    double work = 0.0;
    std::vector<double> y = p.product(x, work);
    EXPECT_NEAR(work, support::dot(x, exact), 1e-5 * std::abs(work));
    // Spins and velocities apart: few spins would drown among many velocities.
    const auto spins = static_cast<std::size_t>(p.toy.resistance.spins() * D);
    double error[2] = {}, size[2] = {};
    for (std::size_t k = 0; k < y.size(); ++k) {
      const int part = k < spins ? 0 : 1;
      error[part] += (y[k] - exact[k]) * (y[k] - exact[k]);
      size[part] += exact[k] * exact[k];
    }
    for (const int part : {0, 1}) {
      EXPECT_LT(error[part], 1e-13 * size[part]) << part;
      EXPECT_GT(error[part], 1e-18 * size[part]) << "it is not in single precision at all";
    }
  }
}

// Slips are differences, so that a translation gives zero without any rounding.
TYPED_TEST(SpinRows, ATranslationCostsNothing) {
  constexpr int D = TypeParam::D;
  const PackedSpinFluid<D> p({.count = 1000, .radius_spread = 1.0});
  const auto spins = static_cast<std::size_t>(p.toy.resistance.spins() * D);
  std::vector<double> x(static_cast<std::size_t>(p.toy.system().size()), 0.0);
  for (std::size_t k = spins; k < x.size(); ++k) x[k] = k % D == 0 ? 1.0 : -0.5;
  double work = 0.0;
  for (const double f : p.product(x, work)) EXPECT_EQ(f, 0.0);
  EXPECT_EQ(work, 0.0);
}

TYPED_TEST(SpinRows, ForcesCancelInTheSum) {
  constexpr int D = TypeParam::D;
  // The force on i and that on j cancel, so the sum over all particles is rounding.
  const PackedSpinFluid<D> p({.count = 1000, .spinning = 0.5, .radius_spread = 1.0});
  const auto spins = static_cast<std::size_t>(p.toy.resistance.spins() * D);
  const auto x = support::random_numbers(static_cast<std::size_t>(p.toy.system().size()), 4);
  double work = 0.0;
  const std::vector<double> y = p.product(x, work);
  for (std::size_t c = 0; c < D; ++c) {
    double sum = 0.0, size = 0.0;
    for (std::size_t k = spins + c; k < y.size(); k += D) {
      sum += y[k];
      size += std::abs(y[k]);
    }
    EXPECT_LT(std::abs(sum), 1e-6 * size);
  }
}

TYPED_TEST(SpinRows, AreTheSameOnAnyNumberOfThreads) {
  std::vector<std::vector<double>> answers;
  for (const int threads : {1, 2, 3}) {
    odpd::set_threads(threads, 0);
    const PackedSpinFluid<TypeParam::D> p({.count = 3000, .spinning = 0.3});
    double work = 0.0;
    answers.push_back(p.product(
        support::random_numbers(static_cast<std::size_t>(p.toy.system().size()), 4), work));
  }
  odpd::set_threads(1, 0);
  EXPECT_EQ(answers[0], answers[1]);
  EXPECT_EQ(answers[0], answers[2]);
}

}  // namespace
