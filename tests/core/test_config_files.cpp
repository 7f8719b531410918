#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "config_test.h"

namespace {

using config_test::error_of;
using config_test::expect_contains;
using config_test::sample;
using odpd::Config;

class ConfigFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* info = ::testing::UnitTest::GetInstance()->current_test_info();
    root_ = std::filesystem::temp_directory_path() /
            ("odpd_config_" + std::string(info->name()) + "_" + std::to_string(getpid()));
    std::filesystem::create_directories(root_);
  }
  void TearDown() override { std::filesystem::remove_all(root_); }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    const std::filesystem::path file = root_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
    return file;
  }
  std::filesystem::path root_;
};

TEST(ConfigResolved, holds_defaults_and_reads_back_to_the_same_bits) {
  const double third = 1.0 / 3.0;
  const double tiny = std::numeric_limits<double>::denorm_min();
  const double huge = std::numeric_limits<double>::max();
  const std::string odd = "quote \" backslash \\ tab \t line\nbell \a end \x7f \xc3\xa9";
  const Config c = Config::from_text(sample + "[empty]\n", "t", {"fluid.a=2.0", "box.size.0=9.0"});
  c.table("fluid").number("third", third);
  c.table("fluid").number("zero", -0.0);
  c.table("fluid").number("round", 1e22);
  c.table("fluid").numbers("ends", {tiny, huge, 0.1});
  c.table("start").text("odd", odd);
  c.table("start").texts("words", {"a", "b"});
  c.table("start").boolean("off", false);
  c.table("start").integer("count", -7);
  c.tables("wall").at(1).number("friction", 4.5);
  c.table("never").has("x");
  const std::string text = c.resolved();

  const Config again = Config::from_text(text, "again");
  const Config fluid = again.table("fluid");
  const auto same = [](double a, double b) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b)) << a << " " << b;
  };
  same(fluid.number("a"), 2.0);
  same(fluid.number("third"), third);
  same(fluid.number("zero"), -0.0);
  same(fluid.number("round"), 1e22);
  same(fluid.numbers("ends").at(0), tiny);
  same(fluid.numbers("ends").at(1), huge);
  same(fluid.numbers("ends").at(2), 0.1);
  EXPECT_EQ(fluid.integer("n"), 4);
  EXPECT_EQ(again.table("box").numbers("size"), (std::vector<double>{9.0, 12.0}));
  EXPECT_EQ(again.table("start").text("odd"), odd);
  EXPECT_EQ(again.table("start").texts("words"), (std::vector<std::string>{"a", "b"}));
  EXPECT_FALSE(again.table("start").boolean("off"));
  EXPECT_EQ(again.table("start").integer("count"), -7);
  EXPECT_EQ(again.tables("wall").at(1).number("friction"), 4.5);
  EXPECT_EQ(again.tables("wall").at(1).table("motion").number("rate"), 0.5);
  EXPECT_TRUE(again.has("empty"));
  EXPECT_FALSE(again.has("never")) << "an absent table without defaults stays absent";
  EXPECT_EQ(again.resolved(), text);
  expect_contains(text, "a = 2.0\n");
}

TEST(ConfigResolved, keeps_unusual_values) {
  const std::string text =
      "\"a.b\" = 1979-05-27T07:32:00Z\nmixed = [[1, 2.0], {x = \"y\"}]\nnone = []\n"
      "[\"odd name\".sub]\nx = inf\n";
  const std::string once = Config::from_text(text, "t").resolved();
  EXPECT_EQ(Config::from_text(once, "t").resolved(), once);
  expect_contains(once, "\"a.b\" = 1979-05-27T07:32:00Z\n");
  expect_contains(once, "mixed = [[1, 2.0], {x = \"y\"}]\n");
  expect_contains(once, "[\"odd name\".sub]\nx = inf\n");
}

TEST(ConfigResolved, leaves_out_defaults_that_would_be_refused) {
  const Config c = Config::from_text("", "t");
  EXPECT_EQ(c.number("limit", std::numeric_limits<double>::infinity()),
            std::numeric_limits<double>::infinity());
  EXPECT_EQ(c.positive("every", 0.0), 0.0);
  EXPECT_EQ(c.choice("kind", {"a", "b"}, ""), "");
  EXPECT_EQ(c.resolved(), "");
}

TEST_F(ConfigFiles, included_tables_merge_and_arrays_are_replaced) {
  write("base/case.toml",
        "title = \"base\"\n[fluid]\na = 18.5\nn = 4\n[[wall]]\nshape = \"plane\"\n"
        "[[wall]]\nshape = \"disc\"\n[box]\nsize = [1.0, 2.0]\n[fluid.noise]\nkT = 1.0\n");
  const auto file = write("derived/case.toml",
                          "include = \"../base\"\n[fluid]\nn = 5\nnoise.seed = 3\n"
                          "[[wall]]\nshape = \"sphere\"\n[box]\nsize = [3.0]\n");
  const Config c = Config::from_file(file.parent_path(), {"fluid.noise.kT=0.5"});
  EXPECT_EQ(c.directory(), file.parent_path());
  EXPECT_EQ(c.text("title"), "base");
  EXPECT_EQ(c.table("fluid").number("a"), 18.5);
  EXPECT_EQ(c.table("fluid").integer("n"), 5);
  EXPECT_EQ(c.table("fluid").table("noise").number("kT"), 0.5);
  EXPECT_EQ(c.table("fluid").table("noise").integer("seed"), 3);
  ASSERT_EQ(c.tables("wall").size(), 1u);
  EXPECT_EQ(c.tables("wall")[0].text("shape"), "sphere");
  EXPECT_EQ(c.table("box").numbers("size"), std::vector<double>{3.0});
  EXPECT_NO_THROW(c.reject_unread()) << "include itself counts as read";
  EXPECT_EQ(c.resolved().find("include"), std::string::npos);

  const std::string base = (root_ / "base/case.toml").string();
  EXPECT_EQ(error_of([&] { c.fail("title", "bad"); }), base + ":1: key 'title': bad");
  EXPECT_EQ(error_of([&] { c.table("fluid").fail("a", "bad"); }), base + ":3: key 'fluid.a': bad");
  EXPECT_EQ(error_of([&] { c.table("fluid").fail("n", "bad"); }),
            file.string() + ":3: key 'fluid.n': bad");
}

TEST_F(ConfigFiles, include_errors) {
  const auto a = write("a.toml", "\ninclude = \"sub/b.toml\"\n");
  const auto b = write("sub/b.toml", "include = \"../a.toml\"\n");
  const std::string loop = error_of([&] { Config::from_file(a); });
  expect_contains(loop, b.string() + ":1: key 'include': files include each other in a circle");
  const auto self = write("self.toml", "include = \"self.toml\"\n");
  expect_contains(error_of([&] { Config::from_file(self); }), "circle");
  const auto lost = write("lost.toml", "include = \"nowhere.toml\"\n");
  expect_contains(error_of([&] { Config::from_file(lost); }),
                  "lost.toml:1: key 'include': " + (root_ / "nowhere.toml").string() +
                      " cannot be read: No such file or directory");
  const auto number = write("number.toml", "include = 3\n");
  expect_contains(error_of([&] { Config::from_file(number); }), "this is an integer (3)");
  write("broken.toml", "x = \n");
  const auto user = write("user.toml", "include = \"broken.toml\"\n");
  expect_contains(error_of([&] { Config::from_file(user); }), "broken.toml:1:");
  // The same file twice along different branches is no circle.
  write("common.toml", "x = 1\n");
  write("mid.toml", "include = \"common.toml\"\ny = 2\n");
  const Config c = Config::from_file(write("top.toml", "include = \"mid.toml\"\nz = 3\n"));
  EXPECT_EQ(c.integer("x") + c.integer("y") + c.integer("z"), 6);
}

TEST_F(ConfigFiles, a_missing_file_is_a_configuration_error) {
  const std::string name = (root_ / "none.toml").string();
  EXPECT_EQ(error_of([&] { Config::from_file(name); }),
            name +
                ": cannot be read: No such file or directory; give a case directory (holding "
                "case.toml) or a .toml file");
  expect_contains(error_of([&] { Config::from_file(root_); }), "case.toml: cannot be read");
  std::filesystem::create_directories(root_ / "case.toml");
  expect_contains(error_of([&] { Config::from_file(root_); }), "Is a directory");
}

TEST_F(ConfigFiles, texts_of_files_are_kept_and_taken_from_elsewhere) {
  write("data/forces.csv", "r,f\n0,1\n");
  const auto file = write(
      "case.toml", "start.file = \"frames.h5\"\n[[pair]]\nforce_file = \"data/forces.csv\"\n");
  const Config c = Config::from_file(file);
  EXPECT_TRUE(c.files().empty());
  EXPECT_EQ(c.table("start").file("file"), root_ / "frames.h5");
  const Config pair = c.tables("pair").at(0);
  EXPECT_EQ(pair.file_text("force_file"), "r,f\n0,1\n");
  const std::string forces = (root_ / "data/forces.csv").string();
  EXPECT_EQ(c.files(), (odpd::ConfigValues{{"pair.0.force_file", forces},
                                           {"start.file", (root_ / "frames.h5").string()}}));
  const odpd::ConfigValues texts{{"pair.0.force_file", "r,f\n0,1\n"}};
  EXPECT_EQ(c.file_texts(), texts);
  c.reject_unread();

  std::filesystem::remove(forces);
  const Config gone = Config::from_file(file);
  const std::string error =
      error_of([&] { gone.tables("pair").at(0).file_text("force_file", "make it"); });
  expect_contains(
      error, "case.toml:3: key 'pair.0.force_file': " + forces + ": cannot be read: No such file");
  expect_contains(error, "; make it");
  gone.use_file_texts(texts);
  EXPECT_EQ(gone.tables("pair").at(0).file_text("force_file"), "r,f\n0,1\n");
  EXPECT_EQ(gone.file_texts(), texts);
  expect_contains(error_of([&] { gone.table("start").file_text("file"); }), "holds no such file");
}

}  // namespace
