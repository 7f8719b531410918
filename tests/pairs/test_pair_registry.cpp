// The table of pair models: names, keys that belong to one of them, and overrides for a pair of species.
#include <gtest/gtest.h>

#include "odpd/pairs/dpd.h"
#include "odpd/pairs/physical_keys.h"
#include "odpd/pairs/registry.h"
#include "support/errors.h"

namespace {

using odpd::Config;
using odpd::ConfigError;
using odpd::FluidKeys;
using support::expect_error;

FluidKeys keys_of(const std::string& text, std::size_t species = 1) {
  const Config config = Config::from_text(text, "case.toml");
  FluidKeys keys{
      .fluid = config.table("fluid"), .pairs = {}, .species = species, .calibration = {}};
  keys.density = 4.0;
  return keys;
}

const std::string standard_fluid = "[fluid]\nkT = 1.0\na = 18.5\ngamma = 4.5\n";

TEST(PairRegistry, TheFirstNameIsTheDefault) {
  ASSERT_FALSE(odpd::pair_model_names().empty());
  EXPECT_EQ(odpd::pair_model_names().front(), "dpd");
  EXPECT_EQ(odpd::read_pair_model<2>(keys_of(standard_fluid))->name(), "dpd");
  EXPECT_EQ(odpd::read_pair_model<3>(keys_of(standard_fluid + "model = \"dpd\"\n"))->cutoff(), 1.0);
  expect_error<ConfigError>(
      [] { odpd::read_pair_model<2>(keys_of(standard_fluid + "model = \"dpb\"\n")); },
      {"fluid.model", "dpd"});
}

TEST(PairRegistry, PairsOfSpeciesOverride) {
  const Config config = Config::from_text(
      standard_fluid + "[[pair]]\na = 60.0\ns = 2.0\n[[pair]]\nsigma = 2.0\n", "case.toml");
  FluidKeys keys{.fluid = config.table("fluid"), .pairs = {}, .species = 3, .calibration = {}};
  const auto entries = config.tables("pair");
  keys.pairs = {{entries[0], 0, 2}, {entries[1], 1, 1}};
  const auto model = odpd::read_pair_model<2>(keys);
  EXPECT_NO_THROW(config.reject_unread());
  const auto& dpd = dynamic_cast<const odpd::DpdModel<2>&>(*model);
  for (const auto& [a, b] : {std::pair{0, 2}, std::pair{2, 0}}) {
    EXPECT_EQ(dpd.parameters({a}, {b}).a, 60.0);
    EXPECT_EQ(dpd.parameters({a}, {b}).s, 2.0);
    EXPECT_EQ(dpd.parameters({a}, {b}).gamma, 4.5);
  }
  EXPECT_DOUBLE_EQ(dpd.parameters({1}, {1}).gamma, 2.0);
  EXPECT_EQ(dpd.parameters({0}, {1}).a, 18.5);
}

TEST(PairRegistry, PhysicalInputsAreOfDpd) {
  for (const char* key : {"eta", "Sc", "tau_P", "alpha", "kappa_inverse"}) {
    const Config config =
        Config::from_text(standard_fluid + std::string(key) + " = 3.0\n", "case.toml");
    expect_error<ConfigError>(
        [&] { odpd::refuse_physical_inputs(config.table("fluid"), "springs"); },
        {key, "fluid.model = \"dpd\"", "\"springs\""});
  }
  const Config config =
      Config::from_text(standard_fluid + "calibration = \"c.json\"\n", "case.toml");
  expect_error<ConfigError>([&] { odpd::refuse_physical_inputs(config.table("fluid"), "springs"); },
                            {"fluid.calibration"});
  EXPECT_NO_THROW(odpd::refuse_physical_inputs(
      Config::from_text(standard_fluid, "case.toml").table("fluid"), "springs"));
}

}  // namespace
