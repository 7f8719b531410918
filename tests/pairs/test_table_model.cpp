// model = "table": forces from tables against DPD's, what is refused, and what holds nearer than a table begins.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "odpd/core/error.h"
#include "odpd/pairs/bonds.h"
#include "odpd/pairs/dpd.h"
#include "odpd/pairs/pair_moments.h"
#include "odpd/pairs/table_model.h"
#include "support/errors.h"
#include "support/network.h"

namespace {

using odpd::ConfigError;
using odpd::ForceTable;
using odpd::PairTerms;
using odpd::Site;
using odpd::TableModel;
using odpd::TableParameters;
using support::expect_error;

std::shared_ptr<const ForceTable> table_of(const std::string& csv) {
  return std::make_shared<const ForceTable>(odpd::parse_csv(csv, "force.csv"));
}

TableModel<2> model_of(const std::string& csv, bool constant_below = false,
                       odpd::FrictionParameters friction = {}) {
  return {1, {TableParameters{table_of(csv), constant_below, friction}}};
}

// 1/r^2 - 1, from r = 0.5 on.
std::string steep() {
  std::string csv = "r,f\n";
  for (int k = 0; k <= 500; ++k) {
    const double r = 0.5 + 0.001 * k;
    csv += std::to_string(r) + "," + std::to_string(1.0 / (r * r) - 1.0) + "\n";
  }
  return csv;
}

TEST(TableModel, OfALinearForceIsDpd) {
  odpd::DpdParameters p{.gamma_perp = 1.5, .kT = 0.7};
  p.gamma_far = 0.1;
  p.cutoff_far = 1.7;
  const odpd::DpdModel<2> dpd(1, {p});
  const TableModel<2> by_force = model_of("r,f\n0.0,18.5\n1.0,0.0\n", false, p.friction());
  const TableModel<2> by_energy =
      model_of("u;R\n9.25;0.0\n2.3125;0.5\n0.37;0.8\n0.0;1.0\n", false, p.friction());
  EXPECT_EQ(by_force.cutoff(), 1.7);
  for (const TableModel<2>* model : {&by_force, &by_energy})
    for (const double r : {0.0, 0.1, 0.6, 0.85, 0.999, 1.0, 1.3, 1.7}) {
      const PairTerms a = dpd.pair(r, Site{}, Site{}), b = model->pair(r, Site{}, Site{});
      EXPECT_NEAR(a.u, b.u, 1e-13) << r;
      EXPECT_NEAR(a.f_c, b.f_c, 1e-12) << r;
      EXPECT_NEAR(a.k_c, b.k_c, 1e-11) << r;
      EXPECT_EQ(a.zeta_par, b.zeta_par);
      EXPECT_EQ(a.zeta_perp, b.zeta_perp);
      EXPECT_EQ(a.kT, b.kT);
    }
}

TEST(TableModel, ATableMayGoOnBeyondTheCutoff) {
  const TableModel<2> model = model_of("r,f\n0.0,4.0\n2.0,2.0\n");
  EXPECT_NEAR(model.pair(0.0, Site{}, Site{}).u, 3.5, 1e-14);
  EXPECT_NEAR(model.pair(0.999999, Site{}, Site{}).u, 3e-6, 1e-10);
  EXPECT_EQ(model.pair(1.0, Site{}, Site{}).f_c, 0.0);
  const TableModel<2> energy = model_of("r,u\n0.0,7.0\n2.0,3.0\n");
  EXPECT_NEAR(energy.pair(0.5, Site{}, Site{}).u, 1.0, 1e-14);
  EXPECT_NEAR(energy.pair(0.5, Site{}, Site{}).f_c, 2.0, 1e-14);
}

TEST(TableModel, NearerThanItBeginsTheForceIsConstant) {
  const TableModel<2> model = model_of(steep(), true);
  const PairTerms first = model.pair(0.5, Site{}, Site{});
  EXPECT_NEAR(first.f_c, 3.0, 1e-6);
  for (const double r : {0.0, 0.2, 0.49999}) {
    const PairTerms t = model.pair(r, Site{}, Site{});
    EXPECT_EQ(t.f_c, first.f_c);
    EXPECT_EQ(t.k_c, 0.0);
    EXPECT_NEAR(t.u, first.u + first.f_c * (0.5 - r), 1e-14);
  }
}

TEST(TableModel, OrNoPairMayBeThere) {
  const TableModel<2> model = model_of(steep());
  EXPECT_TRUE(std::isinf(model.pair(0.49999, Site{}, Site{}).u));
  EXPECT_TRUE(std::isfinite(model.pair(0.5, Site{}, Site{}).u));
  const odpd::PairMoments m = odpd::pair_moments(model, Site{}, Site{});
  EXPECT_FALSE(m.energy.has_value());
  EXPECT_FALSE(m.virial.has_value()) << "f_c below the table is for relaxing a start alone";
  EXPECT_TRUE(m.drag.has_value());
  EXPECT_NEAR(m.force, 3.0, 1e-4);
  support::Fluid<2> fluid(4.0, true);
  fluid.particles.add({1.0, 1.0}, 0);
  fluid.particles.add({2.0, 1.0}, 0);
  fluid.particles.add({1.5, 1.001}, 0);
  fluid.connect(model);
  EXPECT_NO_THROW(model.refuse_unknown(fluid.network, fluid.particles));
  fluid.particles.position[2] = {1.6, 1.0};
  fluid.connect(model);
  expect_error<odpd::BlowUpError>(
      [&] { model.refuse_unknown(fluid.network, fluid.particles); },
      {"particles 1 and 2 are 0.4 apart", "force.csv begins at r = 0.5", "force_below"});
  EXPECT_NO_THROW(model_of(steep(), true).refuse_unknown(fluid.network, fluid.particles));
}

TEST(TableModel, ABondMayTakeAPairOut) {
  odpd::Bond bond{1, 2, {}};
  bond.p.H = 10.0;
  bond.p.exclude = odpd::BondExclusion::repulsion;
  const auto table = std::make_shared<const TableModel<2>>(model_of(steep()));
  const odpd::BondedModel<2> model(table, {bond});
  support::Fluid<2> fluid(4.0, true);
  for (const double x : {1.0, 2.0, 1.6}) fluid.particles.add({x, 1.0}, 0);
  fluid.connect(model);
  EXPECT_NO_THROW(model.refuse_unknown(fluid.network, fluid.particles));
  EXPECT_TRUE(model.excludes(1, 2, fluid.particles) && model.excludes(2, 1, fluid.particles));
  EXPECT_FALSE(model.excludes(0, 1, fluid.particles) || model.excludes(2, 0, fluid.particles));
  const double energy =
      model.bonded_energy(2, fluid.particles.position[2], fluid.box, fluid.particles);
  EXPECT_NEAR(energy, 0.5 * 10.0 * 0.16, 1e-13) << "the pair's infinite energy was left out";
}

TEST(TableModel, EveryPairOfSpeciesHasItsTable) {
  const TableParameters soft{table_of("r,f\n0.0,10.0\n1.0,0.0\n"), false, {}};
  TableParameters hard = soft, none = soft;
  hard.force = table_of("r,f\n0.0,20.0\n1.0,0.0\n");
  none.force = table_of("r,f\n0.0,0.0\n1.0,0.0\n");
  const TableModel<3> model(2, {soft, hard, hard, none});
  const auto force = [&](std::int32_t a, std::int32_t b) {
    return model.pair(0.25, Site{a}, Site{b}).f_c;
  };
  EXPECT_NEAR(force(0, 0), 7.5, 1e-14);
  EXPECT_NEAR(force(0, 1), 15.0, 1e-14);
  EXPECT_EQ(force(0, 1), force(1, 0));
  EXPECT_EQ(force(1, 1), 0.0);
  EXPECT_TRUE(model.conservative());
  EXPECT_FALSE(TableModel<2>(1, {none}).conservative());
  EXPECT_THROW(TableModel<2>(2, {soft, hard, soft, none}), ConfigError);
  EXPECT_THROW(TableModel<2>(2, {soft, hard, hard}), ConfigError);
  EXPECT_THROW(TableModel<2>(1, {TableParameters{}}), ConfigError) << "no table";
}

TEST(TableModel, IntegralsStopAtItsPoints) {
  const auto kinks = model_of("r,f\n0.1,4.0\n0.3,3.0\n0.5,2.5\n1.5,2.0\n").kinks(Site{}, Site{});
  EXPECT_EQ(kinks, (std::vector{0.1, 0.3, 0.5, 1.0}));
}

TEST(TableModel, BadTablesAreRefusedByFileAndLine) {
  const auto refuse = [](const std::string& csv, std::initializer_list<const char*> parts) {
    expect_error<ConfigError>([&] { model_of(csv); }, parts);
  };
  refuse("# LJ\nr,f\n0.0,1.0\n0.4,1.0\n0.3,1.0\n1.0,0.0\n", {"force.csv:5:", "0.3", "ascending"});
  refuse("r,f\n0.0,1.0\n0.4,1.0\n0.4,0.9\n1.0,0.0\n", {"force.csv:4:", "each once"});
  refuse("r,f\n-0.1,1.0\n1.0,0.0\n", {"force.csv:2:", ">= 0"});
  refuse("r,f\n0.0,nan\n1.0,0.0\n", {"force.csv:2:", "'f'", "finite"});
  refuse("r,f\n0.0,1e400\n1.0,0.0\n", {"force.csv:2:", "'f'", "finite"});
  refuse("r,f\n0.0,1.0\n0.1,0.9\n0.2,\n1.0,0.0\n", {"force.csv:4:", "'f'"});
  refuse("r,f\n0.0,1.0\n0.1,0.9\n0.4,0.8\n0.5,0.5\n1.0,0.0\n",
         {"force.csv:4:", "missing between r = 0.1 and r = 0.4"});
  refuse("r,f\n0.0,1.0\n0.5,0.9\n", {"force.csv:3:", "ends at r = 0.5", "cutoff"});
  refuse("r,f\n1.0,1.0\n1.5,0.9\n", {"force.csv:", "begins at r = 1", "cutoff"});
  refuse("r,f\n0.0,1.0\n", {"force.csv:", "1 row"});
  refuse("r,g\n0.0,1.0\n1.0,0.0\n", {"force.csv:", "'f'", "'g'"});
  refuse("x,f\n0.0,1.0\n1.0,0.0\n", {"force.csv:", "'r'", "'x'"});
  refuse("r,f,u\n0.0,1.0,1.0\n1.0,0.0,0.0\n", {"force.csv:", "keep one"});
  EXPECT_NO_THROW(model_of("r,f\n0.0,1.0\n0.1,0.9\n0.3,0.8\n0.4,0.5\n1.0,0.0\n"))
      << "tables may be uneven";
}

}  // namespace
