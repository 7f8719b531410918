// The contract of a pair model (pairs/pair_model.h), for every row of the table of models.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "odpd/core/parallel.h"
#include "odpd/geometry/pair_list.h"
#include "support/dimensions.h"
#include "support/model_examples.h"
#include "support/points.h"

namespace {

using odpd::PairModel;
using odpd::PairNetwork;
using odpd::PairTerms;
using odpd::Site;
using support::ModelExample;

constexpr std::array<std::pair<Site, Site>, 4> site_pairs{
    {{{0}, {0}}, {{0}, {1}}, {{1}, {0}}, {{1}, {1}}}};

template <int D>
std::shared_ptr<const PairModel<D>> model_of(const ModelExample& example) {
  const odpd::Config config = support::example_config(example, D, 5.0);
  odpd::FluidKeys keys{
      .fluid = config.table("fluid"), .pairs = {}, .species = 2, .calibration = {}};
  keys.density = 4.0;
  keys.pairs = {{config.tables("pair")[0], 0, 1}};
  return odpd::read_pair_model<D>(keys);
}

std::array<double, 6> numbers(const PairTerms& t) {
  return {t.u, t.f_c, t.k_c, t.zeta_par, t.zeta_perp, t.kT};
}

// Kinks within the cutoff, each once, 0 before them and the cutoff behind.
template <int D>
std::vector<double> ends_of_stretches(const PairModel<D>& model, Site i, Site j) {
  std::vector<double> ends = model.kinks(i, j);
  EXPECT_TRUE(std::is_sorted(ends.begin(), ends.end()));
  ends.insert(ends.begin(), 0.0);
  ends.push_back(model.cutoff());
  std::erase_if(ends, [&](double r) { return r > model.cutoff(); });
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  return ends;
}

template <class Dimension>
class PairContract : public ::testing::Test {
 protected:
  static constexpr int D = Dimension::D;
  // check(model, name) of every row.
  template <class Check>
  static void for_each_model(const Check& check) {
    for (const ModelExample& example : support::model_examples()) {
      SCOPED_TRACE(example.name);
      check(*model_of<D>(example));
    }
  }
};
TYPED_TEST_SUITE(PairContract, support::Dimensions);

TEST(PairContract, EveryRowOfTheTableHasAnExample) {
  std::vector<std::string> names;
  for (const ModelExample& example : support::model_examples()) names.push_back(example.name);
  EXPECT_EQ(names, odpd::pair_model_names())
      << "add the new row to tests/support/model_examples.h, in the order of pairs/registry.cpp";
}

TYPED_TEST(PairContract, NamesItself) {
  for (const ModelExample& example : support::model_examples()) {
    const auto model = model_of<TypeParam::D>(example);
    EXPECT_EQ(model->name(), example.name);
    EXPECT_TRUE(model->species() == 2 || model->species() == 0);
    EXPECT_FALSE(model->parameters().values.empty()) << "reports have nothing to tell of it";
  }
}

// By differences over five points, a thousandth of the stretch apart: their error is some 1e-10 of the largest value.
TYPED_TEST(PairContract, ForceAndStiffnessAreDerivatives) {
  this->for_each_model([](const auto& model) {
    for (const auto& [i, j] : site_pairs) {
      const auto at = [&, i = i, j = j](double r) { return model.pair(r, i, j); };
      const std::vector<double> ends = ends_of_stretches(model, i, j);
      for (std::size_t k = 0; k + 1 < ends.size(); ++k) {
        const double width = ends[k + 1] - ends[k], h = 1e-3 * width;
        double force = 0.0, stiffness = 0.0;
        for (const double part : {0.05, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95}) {
          force = std::max(force, std::abs(at(ends[k] + part * width).f_c));
          stiffness = std::max(stiffness, std::abs(at(ends[k] + part * width).k_c));
        }
        for (const double part : {0.05, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95}) {
          const double r = ends[k] + part * width;
          const PairTerms a = at(r - 2.0 * h), b = at(r - h), c = at(r + h), d = at(r + 2.0 * h);
          if (std::isinf(at(r).u)) continue;
          const double u_1 = (a.u - 8.0 * b.u + 8.0 * c.u - d.u) / (12.0 * h);
          const double f_1 = (a.f_c - 8.0 * b.f_c + 8.0 * c.f_c - d.f_c) / (12.0 * h);
          EXPECT_NEAR(at(r).f_c, -u_1, 1e-7 * force) << "r = " << r;
          EXPECT_NEAR(at(r).k_c, -f_1, 1e-7 * (stiffness + force / width)) << "r = " << r;
        }
      }
    }
  });
}

TYPED_TEST(PairContract, TheEnergyIsContinuousAndEndsAtZero) {
  this->for_each_model([](const auto& model) {
    for (const auto& [i, j] : site_pairs) {
      const double scale = std::abs(model.pair(0.25 * model.cutoff(), i, j).u);
      ASSERT_TRUE(std::isfinite(scale));
      for (const double r : ends_of_stretches(model, i, j)) {
        if (r == 0.0) continue;
        const double before = model.pair(r * (1.0 - 1e-11), i, j).u,
                     after = model.pair(r * (1.0 + 1e-11), i, j).u;
        if (std::isfinite(before)) {
          EXPECT_NEAR(before, after, 1e-8 * scale) << "r = " << r;
        }
      }
    }
  });
}

TYPED_TEST(PairContract, NothingActsFromTheCutoffOn) {
  this->for_each_model([](const auto& model) {
    for (const auto& [i, j] : site_pairs)
      for (const double r : {1.0, 1.0 + 1e-12, 1.3, 70.0}) {
        const PairTerms t = model.pair(r * model.cutoff(), i, j);
        for (const double value : {t.u, t.f_c, t.k_c, t.zeta_par, t.zeta_perp})
          EXPECT_EQ(value, 0.0);
      }
  });
}

TYPED_TEST(PairContract, TermsAreSymmetricAndFrictionIsNotNegative) {
  this->for_each_model([](const auto& model) {
    bool conservative = model.densities() != nullptr, thermal = false;
    for (const auto& [i, j] : site_pairs)
      for (int k = 0; k <= 200; ++k) {
        const double r = model.cutoff() * k / 200.0;
        const PairTerms t = model.pair(r, i, j);
        EXPECT_EQ(numbers(t), numbers(model.pair(r, j, i)));
        for (const double value : numbers(t)) EXPECT_FALSE(std::isnan(value));
        EXPECT_GE(t.zeta_par, 0.0);
        EXPECT_GE(t.zeta_perp, 0.0);
        EXPECT_GE(t.kT, 0.0);
        conservative = conservative || t.f_c != 0.0;
        thermal = thermal || t.kT > 0.0;
      }
    EXPECT_EQ(model.conservative(), conservative);
    EXPECT_EQ(model.thermal(), thermal);
  });
}

// What an edge has: of a model with densities also what these add to the pair.
template <int D>
PairTerms edge_terms(const PairModel<D>& model, double r, Site i, Site j) {
  PairTerms t = model.pair(r, i, j);
  if (const odpd::Densities* densities = model.densities()) {
    const double slope = densities->energy(i).first + densities->energy(j).first;
    t.f_c -= slope * densities->weight(r, i, j).first;
    t.k_c += slope * densities->weight(r, i, j).second;
  }
  return t;
}

// Kernels fuse multiply-adds and work in another order, so to rounding.
TYPED_TEST(PairContract, EdgesAreWhatItSaysOfPairs) {
  constexpr int D = TypeParam::D;
  this->for_each_model([](const auto& model) {
    odpd::Box<D> box;
    box.size = support::uniform_vec<D>(4.0);
    box.periodic.fill(true);
    odpd::Particles<D> particles;
    for (const auto& r : support::random_points<D>({}, box.size, 300, 8))
      particles.add(r, particles.size() % 3 == 0 ? 1 : 0,
                    particles.size() % 7 == 0 ? odpd::Group::wall(0) : odpd::Group());
    odpd::PairList<D> list(box, model.cutoff(), 0.2);
    list.update(particles.position);
    PairNetwork<D> network, on_threads;
    model.write_edges(list, box, particles.position, particles, network);
    odpd::set_threads(3, 0);
    model.write_edges(list, box, particles.position, particles, on_threads);
    odpd::set_threads(1, 0);
    ASSERT_GT(network.size(), 300);
    bool transverse = false;
    for (std::size_t k = 0; k < network.i.size(); ++k) {
      const auto site = [&](std::int32_t p) {
        const auto at = static_cast<std::size_t>(p);
        return site_of(particles, at, network.densities.empty() ? 0.0 : network.densities.d[at]);
      };
      const auto expected =
          numbers(edge_terms(model, network.r[k], site(network.i[k]), site(network.j[k])));
      const auto edge = [k](const PairNetwork<D>& n) {
        return std::array{n.u[k], n.f_c[k], n.k_c[k], n.zeta_par[k], n.zeta_perp[k], n.kT[k]};
      };
      for (std::size_t c = 0; c < expected.size(); ++c) {
        EXPECT_NEAR(edge(network)[c], expected[c], 1e-12 * std::max(1.0, std::abs(expected[c])));
      }
      EXPECT_EQ(edge(network), edge(on_threads));
      transverse = transverse || expected[4] > 0.0;
    }
    EXPECT_EQ(network.transverse, transverse);
    EXPECT_NO_THROW(model.refuse_unknown(network, particles));
  });
}

}  // namespace
