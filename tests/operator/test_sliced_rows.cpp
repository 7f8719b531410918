// The packed operator is R to single precision, on the kernels of the process's instruction path.
#include <gtest/gtest.h>

#include <cmath>

#include "odpd/core/parallel.h"
#include "odpd/operator/sliced_rows.h"
#include "support/dimensions.h"
#include "support/network.h"

namespace {

template <int D>
struct PackedFluid {
  PackedFluid(std::size_t count, double gamma_perp, double known_below, double shift)
      : fluid(std::pow(static_cast<double>(count) / 8.0, 1.0 / D), true, count, 3, known_below),
        resistance(fluid.box) {
    odpd::DpdParameters p;
    p.gamma_perp = gamma_perp;
    fluid.connect(odpd::DpdModel<D>(1, {p}));
    resistance.rebuild(fluid.network, odpd::DofMap<D>(fluid.particles), fluid.particles,
                       fluid.particles.position, shift);
    rows.pack(resistance);
  }
  odpd::FloatArray packed(const std::vector<double>& x) const {
    odpd::FloatArray v;
    v.resize(rows.vector_size());
    v.fill(0.0F);
    for (std::size_t n = 0; n < rows.place_of_node().size(); ++n)
      for (std::size_t c = 0; c < D; ++c) v.data()[at(n, c)] = static_cast<float>(x[n * D + c]);
    return v;
  }
  std::vector<double> unpacked(const odpd::FloatArray& v) const {
    std::vector<double> x(rows.place_of_node().size() * D);
    for (std::size_t n = 0; n < rows.place_of_node().size(); ++n)
      for (std::size_t c = 0; c < D; ++c) x[n * D + c] = static_cast<double>(v.data()[at(n, c)]);
    return x;
  }
  std::size_t at(std::size_t node, std::size_t component) const {
    const auto stride = static_cast<std::size_t>(rows.vector_size() / rows.places());
    return static_cast<std::size_t>(rows.place_of_node()[node]) * stride + component;
  }

  support::Fluid<D> fluid;
  odpd::Resistance<D> resistance;
  odpd::SlicedRows<D> rows;
};

template <class T>
class SlicedRows : public ::testing::Test {};
TYPED_TEST_SUITE(SlicedRows, support::Dimensions);

TYPED_TEST(SlicedRows, AreTheOperatorToSinglePrecision) {
  constexpr int D = TypeParam::D;
  struct Choice {
    double gamma_perp, known_below, shift;
  };
  // 6 > gamma: zeta_par - zeta_perp changes its sign.
  for (const Choice& c : {Choice{0, 0, 0}, Choice{0, 1, 0}, Choice{1.5, 0, 0.3}, Choice{6, 1, 0}}) {
    const PackedFluid<D> p(1000, c.gamma_perp, c.known_below, c.shift);
    const auto x = support::random_numbers(static_cast<std::size_t>(p.resistance.size()), 9);
    std::vector<double> exact(x.size());
    p.resistance.apply(x, exact);
    const odpd::FloatArray in = p.packed(x);
    odpd::FloatArray out = p.packed(x);
    const double work = p.rows.product(in.data(), out.data(), 0, p.rows.places());
    std::vector<double> y = p.unpacked(out);
    EXPECT_NEAR(work, support::dot(x, exact), 1e-5 * std::abs(work));
    for (std::size_t k = 0; k < y.size(); ++k) y[k] -= exact[k];
    const double error = support::norm(y) / support::norm(exact);
    EXPECT_LT(error, 2e-7);
    EXPECT_GT(error, 1e-9) << "it is not in single precision at all";
  }
}

TYPED_TEST(SlicedRows, EveryNodeHasAPlaceOfItsOwn) {
  const PackedFluid<TypeParam::D> p(777, 0.0, 0.0, 0.0);  // not a multiple of sixteen
  std::vector<int> seen(777, 0);
  for (const std::int32_t node : p.rows.node_of_place())
    if (node >= 0) ++seen[static_cast<std::size_t>(node)];
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), 777);
  for (std::size_t n = 0; n < 777; ++n)
    EXPECT_EQ(p.rows.node_of_place()[static_cast<std::size_t>(p.rows.place_of_node()[n])], n);
  EXPECT_EQ(p.rows.places() % 16, 0);
}

TYPED_TEST(SlicedRows, EmptyPlacesStayZero) {
  const PackedFluid<TypeParam::D> p(777, 0.0, 0.0, 0.0);
  odpd::FloatArray x, y;
  for (odpd::FloatArray* v : {&x, &y}) {
    v->resize(p.rows.vector_size());
    v->fill(7.0F);
  }
  p.rows.product(x.data(), y.data(), 0, p.rows.places());
  const std::int64_t stride = p.rows.vector_size() / p.rows.places();
  for (std::int64_t place = 0; place < p.rows.places(); ++place)
    if (p.rows.node_of_place()[static_cast<std::size_t>(place)] < 0) {
      for (std::int64_t c = 0; c < stride; ++c) EXPECT_EQ(y.data()[place * stride + c], 0.0F);
    }
}

TYPED_TEST(SlicedRows, ForcesCancelInTheSum) {
  constexpr int D = TypeParam::D;
  const PackedFluid<D> p(1000, 1.5, 0.0, 0.0);
  const odpd::FloatArray x =
      p.packed(support::random_numbers(static_cast<std::size_t>(p.resistance.size()), 4));
  odpd::FloatArray out;
  out.resize(p.rows.vector_size());
  p.rows.product(x.data(), out.data(), 0, p.rows.places());
  const std::vector<double> y = p.unpacked(out);
  for (std::size_t c = 0; c < D; ++c) {
    double sum = 0.0, size = 0.0;
    for (std::size_t k = c; k < y.size(); k += D) {
      sum += y[k];
      size += std::abs(y[k]);
    }
    EXPECT_LT(std::abs(sum), 1e-6 * size) << "both directions of an edge hold the same g";
  }
}

TYPED_TEST(SlicedRows, AreTheSameOnAnyNumberOfThreads) {
  std::vector<std::vector<double>> answers;
  for (const int threads : {1, 2, 3}) {
    odpd::set_threads(threads, 0);
    const PackedFluid<TypeParam::D> p(3000, 0.0, 0.0, 0.0);
    const odpd::FloatArray x =
        p.packed(support::random_numbers(static_cast<std::size_t>(p.resistance.size()), 4));
    odpd::FloatArray y;
    y.resize(p.rows.vector_size());
    p.rows.product(x.data(), y.data(), 0, p.rows.places());
    answers.push_back(p.unpacked(y));
  }
  odpd::set_threads(1, 0);
  EXPECT_EQ(answers[0], answers[1]);
  EXPECT_EQ(answers[0], answers[2]);
}

}  // namespace
