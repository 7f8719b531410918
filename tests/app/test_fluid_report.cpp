// The fluid in report, dry run and summary.json, of models with and without the numbers it asks for.
#include <gtest/gtest.h>

#include "odpd/app/fluid_report.h"
#include "odpd/pairs/dpd.h"
#include "odpd/pairs/sdpd.h"
#include "support/pair_functions.h"

namespace {

using odpd::Results;
using odpd::Scene;
using odpd::SceneSettings;

SceneSettings<2> box_of(std::shared_ptr<const odpd::PairModel<2>> model) {
  SceneSettings<2> s;
  s.box = {{{6.0, 6.0}}, {true, true}};
  s.start = odpd::StartKind::lattice;
  s.relax_sweeps = 0;
  s.model = std::move(model);
  return s;
}

void expect_words(const std::string& text, std::initializer_list<const char*> words) {
  for (const char* word : words) EXPECT_NE(text.find(word), std::string::npos) << word << text;
}

TEST(FluidReport, OfDpd) {
  const Scene<2> scene(box_of(odpd::make_dpd<2>({})));
  expect_words(odpd::fluid_text(scene, Results{}),
               {"DPD parameters", "a = 18.5", "eta_friction = 2.87231", "pressure = 42.7463",
                "energy_per_particle = 9.68658", "step_limit = 0.0486486", "cutoff = 1",
                "Sc = infinite", "w_0 = infinite", "l_0 = 0", "tau_P = undefined"});
  expect_words(odpd::fluid_json(scene, Results{}).text(),
               {"\"dpd\"", "\"asked_for\"", "\"kinetic_theory\"", "\"Sc\": null", "\"tau_P\": null",
                "\"l_0\": 0"});
}

TEST(FluidReport, OfAModelOfOnesOwn) {
  const Scene<2> scene(box_of(support::gaussian<2>(18.5, 0.3, 1.0)));
  const std::string text = odpd::fluid_text(scene, Results{});
  expect_words(text, {"pressure = 28.4", "step_limit = 0.0145946", "eta_friction = 2.87231"});
  EXPECT_EQ(text.find("DPD"), std::string::npos);
  const std::string json = odpd::fluid_json(scene, Results{}).text();
  expect_words(json, {"\"function\"", "\"step_limit\": 0.0145"});
  EXPECT_EQ(json.find("asked_for"), std::string::npos);
}

SceneSettings<2> sdpd_box(double background, double support) {
  const odpd::SdpdParameters p{.state = {.d_0 = 4.0, .modulus = 400.0, .background = background},
                               .support = 0.5 * support,
                               .kT = 1.0};
  SceneSettings<2> s = box_of(std::make_shared<const odpd::SdpdModel<2>>(
      p, 1, std::vector{odpd::SdpdFriction::central(2.0, 2)}));
  s.density = 4.0;
  return s;
}

// kappa = 100. What is expected is 0.98 of eta at Gamma = 100 and 0.84 without background pressure; of Gamma = 60 nobody knows.
TEST(FluidReport, OfSdpdSaysWhatTheTableExpects) {
  const Scene<2> scene(sdpd_box(400.0, 3.0));
  expect_words(
      odpd::fluid_text(scene, Results{}),
      {"asked for", "eta = 2 ", "expected", "eta = 1.96", "support = 3, kappa = 100, Gamma = 100"});
  expect_words(odpd::fluid_json(scene, Results{}).text(),
               {"\"viscosity_expected\"", "\"mean\": 1.96"});
  const Scene<2> soft(sdpd_box(0.0, 3.2));
  expect_words(odpd::fluid_text(soft, Results{}), {"eta = 1.6", "Gamma = 0"});
  for (const auto& [background, support] :
       {std::pair{240.0, 2.8}, std::pair{400.0, 3.5}, std::pair{4000.0, 3.0}}) {
    const Scene<2> unknown(sdpd_box(background, support));
    expect_words(odpd::fluid_text(unknown, Results{}), {"expected", "no fluid like this one"});
    EXPECT_EQ(odpd::fluid_json(unknown, Results{}).text().find("viscosity_expected"),
              std::string::npos);
  }
}

TEST(FluidReport, WhatDivergesIsUndefined) {
  const Scene<2> scene(box_of(support::lennard_jones<2>(1.0, 1.0)));
  expect_words(odpd::fluid_text(scene, Results{}),
               {"pressure = undefined", "energy_per_particle = undefined",
                "kappa_inverse = undefined", "eta_friction = 2.87231"});
  expect_words(odpd::fluid_json(scene, Results{}).text(),
               {"\"pressure\": null", "\"energy_per_particle\": null"});
}

}  // namespace
