// Files for other programs: ParaView and gnuplot.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "io/python.h"
#include "io/sample_frame.h"
#include "io/temporary_directory.h"
#include "odpd/core/error.h"
#include "odpd/io/file.h"
#include "odpd/io/gnuplot.h"
#include "odpd/io/vtk.h"

namespace odpd {
namespace {

namespace fs = std::filesystem;
using test::sample_frame;
using test::TemporaryDirectory;

bool gnuplot_is_installed() { return std::system("gnuplot --version > /dev/null 2>&1") == 0; }

/// An environment variable with another value for a while.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    ::setenv(name, value, 1);
  }
  ~Variable() { ::setenv(name_, before_.c_str(), 1); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::string before_;
};

class VtpIn : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dimensions, VtpIn, testing::Values(2, 3));

TEST_P(VtpIn, HoldsEveryParticleOnce) {
  if (!test::python_has("xml.etree.ElementTree")) GTEST_SKIP() << "no python with xml";
  const TemporaryDirectory directory;
  write_vtp(directory / "frame.vtp", sample_frame(GetParam(), 7, 20));
  EXPECT_EQ(test::run_python(directory.path(), R"(
import sys, xml.etree.ElementTree as tree
root = tree.parse(sys.argv[1]).getroot()
assert root.tag == 'VTKFile' and root.get('type') == 'PolyData'
piece = root.find('PolyData/Piece')
assert piece.get('NumberOfPoints') == '7' and piece.get('NumberOfVerts') == '7'
numbers = lambda e: [float(w) for w in e.text.split()]
points = numbers(piece.find('Points/DataArray'))
assert len(points) == 21
assert piece.find('Points/DataArray').get('NumberOfComponents') == '3'
data = {e.get('Name'): numbers(e) for e in piece.findall('PointData/DataArray')}
assert len(data['velocity']) == 21 and data['velocity'][3:5] == [0.5, 0.4]
assert data['id'] == [10, 13, 16, 19, 22, 25, 28]
assert data['species'] == [0, 1, 0, 1, 0, 1, 0] and data['group'] == [0, 1, 2, 0, 1, 2, 0]
verts = {e.get('Name'): numbers(e) for e in piece.findall('Verts/DataArray')}
assert verts['connectivity'] == list(range(7)) and verts['offsets'] == list(range(1, 8))
assert numbers(root.find('PolyData/FieldData/DataArray')) == [0.1]
)",
                             directory / "frame.vtp"),
            0);
  if (GetParam() == 2) {
    EXPECT_NE(read_file(directory / "frame.vtp").find(" 0\n"), std::string::npos);
  }
}

// In 2D about z, the component out of the plane.
TEST_P(VtpIn, AngularVelocitiesAreVectors) {
  const TemporaryDirectory directory;
  Frame frame = sample_frame(GetParam(), 2, 20);
  frame.spin = GetParam() == 2 ? std::vector<double>{1.5, -2.5}
                               : std::vector<double>{1.5, 2.0, 3.0, -2.5, 4.0, 5.0};
  write_vtp(directory / "frame.vtp", frame);
  const std::string text = read_file(directory / "frame.vtp");
  const std::size_t at = text.find("\"angular_velocity\" NumberOfComponents=\"3\"");
  ASSERT_NE(at, std::string::npos);
  const std::string values = GetParam() == 2 ? "0 0 1.5\n0 0 -2.5\n" : "1.5 2 3\n-2.5 4 5\n";
  EXPECT_EQ(text.substr(text.find('\n', at) + 1, values.size()), values);
}

TEST(Vtp, LeavesOutWhatTheFrameDoesNotHave) {
  const TemporaryDirectory directory;
  Frame frame;
  frame.id = {0, 1};
  frame.position = {1.0, 2.0, 3.0, 4.0};
  write_vtp(directory / "frame.vtp", frame);
  const std::string text = read_file(directory / "frame.vtp");
  EXPECT_NE(text.find("1 2 0\n3 4 0\n"), std::string::npos);
  EXPECT_NE(text.find("\"id\""), std::string::npos);
  EXPECT_EQ(text.find("\"velocity\""), std::string::npos);
  EXPECT_EQ(text.find("\"density\""), std::string::npos);
  frame.density = {0.25, 0.5};
  write_vtp(directory / "frame.vtp", frame);
  EXPECT_NE(
      read_file(directory / "frame.vtp").find("Name=\"density\" format=\"ascii\">\n0.25 0.5\n"),
      std::string::npos);
  EXPECT_EQ(text.find("\"species\""), std::string::npos);
}

TEST(Pvd, ListsTimesAndEscapedNames) {
  const TemporaryDirectory directory;
  write_pvd(directory / "all.pvd", {{0.5, "a<b>&\"c\".vtp"}, {1.0 / 3.0, "2.vtp"}});
  const std::string text = read_file(directory / "all.pvd");
  EXPECT_NE(text.find("timestep=\"0.5\" part=\"0\" file=\"a&lt;b&gt;&amp;&quot;c&quot;.vtp\""),
            std::string::npos);
  EXPECT_NE(text.find("timestep=\"0.3333333333333333\""), std::string::npos);
}

TEST(VtkFrames, AnEndBeforeTheEndLeavesNoFrame) {
  const TemporaryDirectory directory;
  VtkFrames whole(directory.path());
  for (const int step : {20, 40}) whole.append(sample_frame(2, 3, step));
  const std::string twenty_forty = read_file(directory / "particles.pvd");
  whole.append_last(sample_frame(2, 3, 40));
  EXPECT_EQ(read_file(directory / "particles.pvd"), twenty_forty) << "it is there already";
  whole.append_last(sample_frame(2, 3, 47));
  EXPECT_NE(read_file(directory / "particles.pvd").find("0000000047.vtp"), std::string::npos);
  EXPECT_EQ(whole.steps(), (std::vector<std::int64_t>{20, 40}));
  write_file_atomically(directory / "frames/notes.vtp", std::string("not ours"));

  VtkFrames resumed(directory.path());
  resumed.resume_at(whole.times(), whole.steps());
  EXPECT_EQ(read_file(directory / "particles.pvd"), twenty_forty);
  EXPECT_FALSE(std::filesystem::exists(directory / "frames/0000000047.vtp"));
  EXPECT_TRUE(std::filesystem::exists(directory / "frames/0000000040.vtp"));
  EXPECT_TRUE(std::filesystem::exists(directory / "frames/notes.vtp"));
  VtkFrames(directory.path()).resume_at({}, {});
  EXPECT_FALSE(std::filesystem::exists(directory / "particles.pvd"));
}

Chart sample_chart() {
  Chart chart{"It's a `title` of $HOME_\xCE\xB7", "y", "v_x", false, false, {}};
  chart.curves.push_back({"measured", {1, 2, 3}, {1, 4, 9}, {0.1, 0.2, 0.3}, false, true});
  chart.curves.push_back({"theory", {1, 3}, {1, 9}, {}, true, false});
  return chart;
}

void expect_pictures(const fs::path& stem) {
  const std::string png = read_file(stem.string() + ".png");
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_NE(png.find("IEND"), std::string::npos);
  EXPECT_NE(read_file(stem.string() + ".svg").find("</svg>"), std::string::npos);
}

TEST(Gnuplot, DrawsCharts) {
  if (!gnuplot_is_installed()) GTEST_SKIP() << "gnuplot is not installed";
  const TemporaryDirectory directory;
  ASSERT_TRUE(draw_chart(directory / "it's a chart", sample_chart()));
  expect_pictures(directory / "it's a chart");
  const std::string svg = read_file(directory / "it's a chart.svg");
  EXPECT_NE(svg.find("It's a `title` of $HOME_\xCE\xB7"), std::string::npos)
      << "the title must appear as it was given";
  EXPECT_NE(svg.find("measured"), std::string::npos);
}

TEST(Gnuplot, DrawsWhateverTheDataAre) {
  if (!gnuplot_is_installed()) GTEST_SKIP() << "gnuplot is not installed";
  const TemporaryDirectory directory;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<Curve> curves{{"nothing", {}, {}, {}},
                                  {"nan", {1, 2}, {nan, infinity}, {}},
                                  {"one", {1}, {2}, {}},
                                  {"flat", {1, 2}, {0, 0}, {}},
                                  {"signs", {-1, 1, 2}, {-1, 1, 3}, {9, 9, nan}},
                                  {"band", {1, 2}, {2, 3}, {5, 1}, true, false},
                                  {"wide", {1e-9, 1e9}, {1e-200, 1e200}, {}},
                                  {"close", {1.0001, 1.0002}, {5.0001, 5.0002}, {}, true, true}};
  for (const Curve& curve : curves) {
    for (const bool log : {false, true}) {
      const Chart chart{"title", "x", "y", log, log, {curve}};
      EXPECT_TRUE(draw_chart(directory / "chart", chart)) << curve.title << " " << log;
      expect_pictures(directory / "chart");
    }
  }
  EXPECT_TRUE(draw_chart(directory / "chart", {}));
  Chart uneven = sample_chart();
  uneven.curves[0].y.pop_back();
  EXPECT_THROW(draw_chart(directory / "chart", uneven), IoError);
}

TEST(Gnuplot, DrawsUpperLimitsHollowAndABackdropWithLabels) {
  if (!gnuplot_is_installed()) GTEST_SKIP() << "gnuplot is not installed";
  const TemporaryDirectory directory;
  Chart chart{"limits", "cost", "error", true, true, {}};
  chart.curves.push_back(
      {.title = "front", .x = {1, 2}, .y = {3, 2}, .error = {}, .line = true, .points = false});
  chart.curves.back().backdrop = true;
  chart.curves.back().label = {"0.05", "a \"b\""};
  chart.curves.push_back({"method", {1, 2, 3}, {3, 2, 1}, {0.1, 0.1, 0.9}, true, true});
  EXPECT_TRUE(draw_chart(directory / "chart", chart));
  EXPECT_EQ(read_file(directory / "chart.svg").find("below the noise"), std::string::npos);
  chart.curves.back().limit = {false, false, true};
  EXPECT_TRUE(draw_chart(directory / "chart", chart));
  const std::string svg = read_file(directory / "chart.svg");
  EXPECT_NE(svg.find("below the noise"), std::string::npos);
  EXPECT_NE(svg.find("0.05"), std::string::npos);
}

TEST(Gnuplot, DrawsMaps) {
  if (!gnuplot_is_installed()) GTEST_SKIP() << "gnuplot is not installed";
  const TemporaryDirectory directory;
  CellMap map;
  map.title = "it's a map";
  map.x_label = "dt";
  map.y_label = "a";
  map.x_ticks = {"0.1", "0.2"};
  map.y_ticks = {"5"};
  map.kinds = {{"fine", "#a8d8b9"}, {"broken", "#e57368"}};
  map.panels = {{"one", {{{0, "+1 %"}, {1, "t = 3"}}}}, {"two", {{{7, ""}, {0, "0"}}}}};
  EXPECT_TRUE(draw_map(directory / "map", map));
  expect_pictures(directory / "map");
  const std::string svg = read_file(directory / "map.svg");
  for (const char* text : {"it's a map", "one", "two", "+1 %", "t = 3", "fine", "broken"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  EXPECT_TRUE(draw_map(directory / "empty", {}));
}

TEST(Gnuplot, DrawsParticles) {
  if (!gnuplot_is_installed()) GTEST_SKIP() << "gnuplot is not installed";
  const TemporaryDirectory directory;
  for (const int dimension : {2, 3}) {
    ASSERT_TRUE(draw_particles(directory / "frame", sample_frame(dimension, 9, 1), 1));
    expect_pictures(directory / "frame");
  }
  Frame bare;
  bare.id = {0, 1};
  bare.position = {1.0, 2.0, 3.0, 4.0};
  EXPECT_TRUE(draw_particles(directory / "frame", bare, 0));
  bare = {};
  EXPECT_TRUE(draw_particles(directory / "frame", bare, 0));
  EXPECT_THROW(draw_particles(directory / "frame", sample_frame(2, 9, 1), 2), IoError);
}

TEST(Gnuplot, SaysWhenThePicturesCannotBeWritten) {
  if (!gnuplot_is_installed()) GTEST_SKIP() << "gnuplot is not installed";
  const TemporaryDirectory directory;
  EXPECT_THROW(draw_chart(directory / "absent" / "chart", sample_chart()), IoError);
  fs::create_directories(directory / "chart.png" / "inside");
  EXPECT_THROW(draw_chart(directory / "chart", sample_chart()), IoError);
}

TEST(Gnuplot, MissingProgramKeepsTheScript) {
  const TemporaryDirectory directory;
  const Variable path("PATH", directory.path().c_str());
  EXPECT_FALSE(draw_chart(directory / "chart", sample_chart()));
  EXPECT_TRUE(fs::exists(directory / "chart.gp"));
  EXPECT_FALSE(fs::exists(directory / "chart.png"));
}

}  // namespace
}  // namespace odpd
