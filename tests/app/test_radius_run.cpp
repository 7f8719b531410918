// The scenes of odpd calibrate --radius: what they take from a case, and what they measure of bodies of which the answer is known.
#include <gtest/gtest.h>

#include "odpd/app/radius_run.h"
#include "odpd/app/simulation.h"
#include "odpd/core/error.h"

namespace {

using odpd::BodyInCell;
using odpd::MeasuredBody;

MeasuredBody body_of(const std::string& text, const std::string& name = "") {
  const odpd::Config config = odpd::Config::from_text(text, "test");
  const odpd::Simulation<2> simulation(config, odpd::read_case(config, "test"));
  return odpd::measured_body(config, simulation.scene(), simulation.clock().dt, name);
}

std::string case_with(const std::string& fluid, const std::string& rest) {
  return "dimension = 2\nseed = 3\n[box]\nsize = [12.0, 12.0]\nperiodic = [true, "
         "true]\n[fluid]\nkT = "
         "1.0\n" +
         fluid + "[integrator]\ndt = 0.01\n[run]\nduration = 1.0\n" + rest;
}

const std::string dimer =
    "[[body]]\nname = \"dimer\"\nshape = \"points\"\ncount = 2\nforce = [1.0, 0.0]\n"
    "points = [{ at = [0.0, 0.0] }, { at = [1.5, 0.0] }]\n";

// Two particles of the fluid itself, too far apart to meet, are two of N more: they take 2/n.
TEST(RadiusRun, ParticlesOfTheFluidExcludeTheirShare) {
  const MeasuredBody m = body_of(case_with("density = 4.0\na = 18.5\ngamma = 4.5\n", dimer));
  const BodyInCell cell = odpd::measure_body(
      m, 5.0, 0.5, 1, [](const BodyInCell& c) { return odpd::excluded_volume(c).error < 0.12; },
      [] { return false; });
  EXPECT_EQ(cell.sites, 2);
  EXPECT_EQ(cell.particles, 100);  // 4 (25 - .5) and two
  EXPECT_NEAR(odpd::excluded_volume(cell).value, 0.5, 3.0 * 0.12);
}

// A disk that is no smaller than the reach of friction is as large to a flow that it drags as to one that it turns; without a pressure in the
// estimator it would be a quarter smaller to the former.
TEST(RadiusRun, DragAndTorqueAgree) {
  const MeasuredBody m =
      body_of(case_with("density = 4.0\na = 18.5\ngamma = 4.5\n",
                        "[[body]]\nname = \"disk\"\nshape = \"disk\"\nradius = 1.0\nrings = 3\n"));
  const auto never = [] { return false; };
  const odpd::PureFluid fluid = odpd::measure_pure_fluid(
      m, 1, [](const odpd::PureFluid& f) { return f.eta.error < 0.01 * f.eta.value; }, never);
  EXPECT_DOUBLE_EQ(fluid.density.value, 4.0);
  const odpd::FluidViscosity viscosity{fluid.eta.value, fluid.density.value,
                                       m.viscosity_exponent()};
  const BodyInCell cell = odpd::measure_body(
      m, 9.0, 5.0, 1,
      [&](const BodyInCell& c) {
        const odpd::Measured a = odpd::drag_radius(c, viscosity);
        return a.error < 0.02 * a.value;
      },
      never);
  const odpd::Measured drag = odpd::drag_radius(cell, viscosity),
                       torque = odpd::torque_radius(cell, viscosity);
  EXPECT_NEAR(torque.value, 1.0, 0.05) << drag.value;
  EXPECT_NEAR(drag.value / torque.value, 1.03, 0.08) << drag.value << " " << torque.value;
}

TEST(RadiusRun, TakesFluidAndBodyOfACase) {
  const std::string disks =
      "[[species]]\nname = \"solvent\"\n[[species]]\nname = \"disk\"\ncount = 0\n"
      "[[pair]]\nspecies = [\"solvent\", \"disk\"]\na = 10.0\n"
      "[[body]]\nname = \"disk\"\nspecies = \"disk\"\nshape = \"disk\"\nradius = 1.0\nrings = 2\n"
      "count = 2\nexcluded_volume = 5.0\n" +
      dimer;
  // By its count, of physical inputs that go by the density.
  const std::string text = case_with("count = 432\na = 18.5\neta = 2.0\n", disks);
  const MeasuredBody m = body_of(text, "disk");
  EXPECT_DOUBLE_EQ(m.density, 3.0);
  EXPECT_EQ(m.sites, 19);
  EXPECT_NEAR(m.reach, 1.0, 1e-12);
  EXPECT_TRUE(m.round);
  EXPECT_FALSE(body_of(text, "dimer").round);
  EXPECT_EQ(m.fluid.find("eta"), std::string::npos);
  EXPECT_NE(m.fluid.find("gamma = "), std::string::npos);
  EXPECT_NE(m.species.find("a = 10"), std::string::npos);
  EXPECT_EQ(m.body.find("excluded_volume"), std::string::npos);
  EXPECT_DOUBLE_EQ(m.far(6.0), 2.5);
  EXPECT_DOUBLE_EQ(m.far(4.4), 2.2);
  // The scene made of them is the one asked for.
  std::int64_t looked = 0;
  const BodyInCell cell = odpd::measure_body(
      m, 6.0, 4.0, 1, [&](const BodyInCell&) { return ++looked == 2; }, [] { return false; });
  EXPECT_EQ(cell.samples, 2);
  EXPECT_EQ(cell.particles, 3 * (36 - 4) + 19);
  EXPECT_THROW(body_of(text), odpd::ConfigError);
}

// A colloid of one particle that spins: its own cutoff sets how far it reaches, the fluid's sets the grid of the pressure. Its radii by drag and
// by torque agree, as a pressure makes the flow around it Stokes flow.
TEST(RadiusRun, OfOneParticle) {
  const MeasuredBody m = body_of(case_with(
      "density = 4.0\na = 18.5\ngamma = 4.5\n",
      "[[species]]\nname = \"solvent\"\n[[species]]\nname = \"colloid\"\ncount = 0\n"
      "lever_radius = 1.0\n"
      "[[pair]]\nspecies = [\"solvent\", \"colloid\"]\ncore = 1.0\ncutoff = 1.8\ngamma = 45.0\n"
      "gamma_perp = 45.0\n"
      "[[molecule]]\nname = \"ball\"\nspecies = \"colloid\"\nshape = \"particle\"\ncount = 3\n"
      "clearance = 3.0\nexcluded_volume = 4.0\n"));
  EXPECT_EQ(m.entry, "molecule");
  EXPECT_EQ(m.name, "ball");
  EXPECT_EQ(m.sites, 1);
  EXPECT_DOUBLE_EQ(m.reach, 1.3);
  EXPECT_DOUBLE_EQ(m.cutoff, 1.0);
  EXPECT_DOUBLE_EQ(m.density, 576.0 / 132.0);
  const auto never = [] { return false; };
  const odpd::PureFluid fluid = odpd::measure_pure_fluid(
      m, 1, [](const odpd::PureFluid& f) { return f.eta.error < 0.02 * f.eta.value; }, never);
  const odpd::FluidViscosity viscosity{fluid.eta.value, fluid.density.value, 2.0};
  const BodyInCell cell = odpd::measure_body(
      m, 7.5, 4.0, 1,
      [&](const BodyInCell& c) {
        const odpd::Measured a = odpd::drag_radius(c, viscosity);
        return a.error < 0.03 * a.value;
      },
      never);
  const double drag = odpd::drag_radius(cell, viscosity).value;
  EXPECT_NEAR(drag, 1.6, 0.2);
  EXPECT_NEAR(odpd::torque_radius(cell, viscosity).value / drag, 1.0, 0.1);
}

// What a species says of its spin is that of the scenes measured, a lever radius of 0 beside one of [fluid] too.
TEST(RadiusRun, OfAFluidWhoseOwnSpeciesDoesNotSpin) {
  const std::string colloid =
      "[[species]]\nname = \"colloid\"\ncount = 0\n"
      "[[pair]]\nspecies = [\"solvent\", \"colloid\"]\ncore = 1.0\ncutoff = 1.8\n"
      "gamma_perp = 45.0\n"
      "[[molecule]]\nname = \"ball\"\nspecies = \"colloid\"\nshape = \"particle\"\ncount = 1\n"
      "clearance = 3.0\nexcluded_volume = 4.0\n";
  const std::string fluid = "density = 4.0\na = 18.5\ngamma = 4.5\nlever_radius = 1.0\n";
  const MeasuredBody m =
      body_of(case_with(fluid, "[[species]]\nname = \"solvent\"\nlever_radius = 0.0\n" + colloid));
  EXPECT_NE(m.species.find("name = \"solvent\"\nlever_radius = 0"), std::string::npos) << m.species;
  EXPECT_NE(m.species.find("name = \"colloid\"\nlever_radius = 1"), std::string::npos) << m.species;
}

// The fluid between bodies that say what they take, without beads of molecules.
TEST(RadiusRun, DensityOfTheFluidAlone) {
  const std::string disks =
      "[[body]]\nname = \"disk\"\nshape = \"disk\"\nradius = 1.0\nrings = 2\ncount = 4\n";
  const std::string chains =
      "[[molecule]]\nname = \"pair\"\nspecies = \"fluid\"\nshape = \"chain\"\nbeads = 2\nspacing = "
      "0.3\nH = "
      "100.0\ncount = 9\n";
  const std::string fluid = "count = 432\na = 18.5\ngamma = 4.5\n";
  EXPECT_DOUBLE_EQ(body_of(case_with(fluid, disks)).density, 3.0);
  EXPECT_DOUBLE_EQ(body_of(case_with(fluid, disks + "excluded_volume = 6.0\n")).density, 3.6);
  EXPECT_DOUBLE_EQ(body_of(case_with(fluid, disks + chains)).density, 3.0);
  EXPECT_DOUBLE_EQ(body_of(case_with("density = 3.0\na = 18.5\ngamma = 4.5\n",
                                     disks + "excluded_volume = 6.0\n"))
                       .density,
                   3.6);
}

// Whole multiples of 1.5 cutoffs, about 4, 6 and 8 or 4, 5 and 6 times half a cutoff more than the reach.
TEST(RadiusRun, EdgesAreWholeCellsOfThePressure) {
  MeasuredBody m;
  m.reach = 1.2;
  EXPECT_EQ(m.default_edges(), (std::vector<double>{7.5, 9.0, 10.5}));
  m.dimension = 2;
  EXPECT_EQ(m.default_edges(), (std::vector<double>{7.5, 10.5, 13.5}));
  m.cutoff = 2.0;
  EXPECT_EQ(m.default_edges(), (std::vector<double>{9.0, 15.0, 18.0}));
}

}  // namespace
