#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "config_test.h"

namespace {

using config_test::error_of;
using config_test::expect_contains;
using config_test::sample;
using odpd::Config;
using odpd::nearest_name;

TEST(Config, reads_every_type) {
  const Config c = Config::from_text(
      "x = 1.5\nwhole = 3\non = true\nname = \"n\"\nxs = [1, 2.5]\nflags = [true, false]\n"
      "words = [\"a\", \"b\"]\n",
      "t.toml");
  EXPECT_EQ(c.number("x"), 1.5);
  EXPECT_EQ(c.number("whole"), 3.0);
  EXPECT_EQ(c.integer("whole"), 3);
  EXPECT_TRUE(c.boolean("on"));
  EXPECT_EQ(c.text("name"), "n");
  EXPECT_EQ(c.numbers("xs"), (std::vector<double>{1.0, 2.5}));
  EXPECT_EQ(c.booleans("flags"), (std::vector<bool>{true, false}));
  EXPECT_EQ(c.texts("words"), (std::vector<std::string>{"a", "b"}));
  EXPECT_NO_THROW(c.reject_unread());
}

TEST(Config, wrong_types_name_file_line_key_and_value) {
  const Config c = Config::from_text(
      "title = 1\n[fluid]\na = \"abc\"\nn = 1.0\nm = nan\nk = [1.0,\n  \"x\"]\nd = 2020-01-31\n",
      "case.toml");
  const Config fluid = c.table("fluid");
  EXPECT_EQ(error_of([&] { c.text("title"); }),
            "case.toml:1: key 'title': a string is needed, this is an integer (1)");
  EXPECT_EQ(error_of([&] { fluid.number("a"); }),
            "case.toml:3: key 'fluid.a': a number is needed, this is a string (\"abc\")");
  EXPECT_EQ(error_of([&] { fluid.integer("n"); }),
            "case.toml:4: key 'fluid.n': an integer is needed, this is a number (1.0)");
  EXPECT_EQ(error_of([&] { fluid.number("m"); }),
            "case.toml:5: key 'fluid.m': must be finite, this is nan");
  EXPECT_EQ(error_of([&] { fluid.number("m", 1.0); }),
            "case.toml:5: key 'fluid.m': must be finite, this is nan");
  EXPECT_EQ(error_of([&] { fluid.numbers("k"); }),
            "case.toml:7: key 'fluid.k.1': a number is needed, this is a string (\"x\")");
  EXPECT_EQ(error_of([&] { fluid.numbers("n"); }),
            "case.toml:4: key 'fluid.n': an array of numbers is needed, this is a number (1.0)");
  EXPECT_EQ(error_of([&] { fluid.boolean("d"); }),
            "case.toml:8: key 'fluid.d': true or false is needed, this is a date (2020-01-31)");
  EXPECT_EQ(error_of([&] { c.table("title"); }),
            "case.toml:1: key 'title': a table ([title]) is needed, this is an integer (1)");
  EXPECT_EQ(error_of([&] { c.tables("fluid"); }),
            "case.toml:2: key 'fluid': an array of tables ([[fluid]]) is needed, this is a table");
}

TEST(Config, missing_keys_say_where_to_add_them) {
  const Config c = Config::from_text(sample, "case.toml");
  EXPECT_EQ(error_of([&] { c.integer("seed"); }),
            "case.toml: key 'seed' is missing: add it at the top of the file, before the first "
            "[table]");
  EXPECT_EQ(error_of([&] { c.table("integrator").number("dt"); }),
            "case.toml: key 'integrator.dt' is missing: add it under [integrator]");
  EXPECT_EQ(error_of([&] { c.table("fluid").table("noise").number("kT"); }),
            "case.toml: key 'fluid.noise.kT' is missing: add it under [fluid.noise]");
  EXPECT_EQ(error_of([&] { c.tables("wall").at(1).number("radius"); }),
            "case.toml:16: key 'wall.1.radius' is missing: add it under [[wall]]");
  EXPECT_EQ(error_of([&] { c.tables("wall").at(1).table("motion").number("phase"); }),
            "case.toml: key 'wall.1.motion.phase' is missing: add it under [wall.motion]");
}

TEST(Config, ranges_are_stated) {
  const Config c = Config::from_text("a = 0.0\nb = -1\nn = 0\n", "t");
  expect_contains(error_of([&] { c.positive("a"); }), "t:1: key 'a': must be positive");
  expect_contains(error_of([&] { c.positive("b", 1.0); }), "t:2: key 'b': must be positive");
  EXPECT_EQ(c.non_negative("a"), 0.0);
  expect_contains(error_of([&] { c.non_negative("b"); }), "must not be negative (>= 0)");
  expect_contains(error_of([&] { c.positive_integer("n", 1); }), "(>= 1), this is 0");
  EXPECT_EQ(c.positive("absent", 2.0), 2.0);
}

TEST(Config, choice_lists_names_and_the_nearest) {
  const Config c = Config::from_text("kind = \"pgc\"\nother = \"petsc\"\n", "t");
  const std::vector<std::string> names{"picard", "pcg", "petsc"};
  EXPECT_EQ(c.choice("other", names), "petsc");
  EXPECT_EQ(c.choice("absent", names, "picard"), "picard");
  EXPECT_EQ(error_of([&] { c.choice("kind", names); }),
            "t:1: key 'kind': must be one of picard, pcg, petsc; this is \"pgc\", did you mean "
            "'pcg'?");
}

TEST(Config, tables_and_arrays_of_tables) {
  const Config c = Config::from_text(sample, "case.toml");
  const std::vector<Config> walls = c.tables("wall");
  ASSERT_EQ(walls.size(), 2u);
  EXPECT_EQ(walls[0].text("shape"), "plane");
  EXPECT_EQ(walls[1].table("motion").number("rate"), 0.5);
  EXPECT_TRUE(c.tables("observe").empty());
  EXPECT_TRUE(c.has("box"));
  EXPECT_FALSE(c.has("observe"));
  const Config absent = c.table("start");
  EXPECT_FALSE(absent.has("file"));
  EXPECT_EQ(absent.text("file", "x.h5"), "x.h5");
  EXPECT_FALSE(absent.has("file")) << "a default is not part of the case";
  EXPECT_FALSE(c.has("start"));
  const Config kinds = Config::from_text("a = [1]\nb = { c = 1 }\nd = 1\n[[e]]\n", "t");
  for (const char* key : {"a", "b", "d", "e", "none"}) {
    EXPECT_EQ(kinds.is_array(key), std::string("ae").find(key) != std::string::npos) << key;
    EXPECT_EQ(kinds.is_table(key), std::string(key) == "b") << key;
  }
  const Config inlined = Config::from_text("wall = [{x = 1}, {x = 2}]\nnone = []\nbad = [1]", "t");
  EXPECT_EQ(inlined.tables("wall").at(1).integer("x"), 2);
  EXPECT_TRUE(inlined.tables("none").empty());
  EXPECT_EQ(error_of([&] { inlined.tables("bad"); }),
            "t:3: key 'bad.0': a table is needed, this is an integer (1)");
}

TEST(Config, handles_share_one_tree) {
  std::string resolved;
  {
    const Config fluid = [] { return Config::from_text(sample, "t").table("fluid"); }();
    const Config copy = fluid;
    EXPECT_EQ(copy.number("gamma", 4.5), 4.5);
    resolved = fluid.resolved();
  }
  expect_contains(resolved, "gamma = 4.5");
}

TEST(Config, fail_names_the_place) {
  const Config c = Config::from_text(sample, "case.toml", {"fluid.n=5"});
  EXPECT_EQ(error_of([&] { c.table("fluid").fail("a", "bad"); }),
            "case.toml:9: key 'fluid.a': bad");
  EXPECT_EQ(error_of([&] { c.table("fluid").fail("n", "bad"); }), "--set fluid.n: bad");
  EXPECT_EQ(error_of([&] { c.table("fluid").fail("kT", "bad"); }),
            "case.toml:8: key 'fluid.kT': bad");
  EXPECT_EQ(error_of([&] { c.table("fluid").fail("", "bad"); }), "case.toml:8: key 'fluid': bad");
  EXPECT_EQ(error_of([&] { c.tables("wall").at(1).fail("shape", "bad"); }),
            "case.toml:17: key 'wall.1.shape': bad");
  EXPECT_EQ(error_of([&] { c.fail("seed", "bad"); }), "case.toml: key 'seed': bad");
  EXPECT_EQ(error_of([&] { c.table("start").fail("file", "bad"); }),
            "case.toml: key 'start.file': bad");
}

TEST(Config, syntax_errors_have_line_and_column) {
  const std::string message = error_of([] { Config::from_text("a = 1\nb = [1,\n", "x.toml"); });
  EXPECT_EQ(message.rfind("x.toml:", 0), 0u) << message;
  expect_contains(message, "not valid TOML: ");
  expect_contains(error_of([] { Config::from_text("a = 1\nb = = 2\n", "x.toml"); }), "x.toml:2:5:");
  expect_contains(error_of([] { Config::from_text("a = 1\na = 2\n", "x.toml"); }), "x.toml:2:");
}

TEST(ConfigUnread, a_complete_reading_passes_and_each_unread_key_is_found) {
  const auto read = [](const Config& c, bool velocity, bool rate) {
    c.text("title");
    c.integer("dimension");
    c.table("box").numbers("size");
    c.table("box").booleans("periodic");
    c.table("fluid").number("a");
    c.table("fluid").number("n");
    for (const Config& wall : c.tables("wall")) {
      wall.text("shape");
      if (velocity) wall.numbers("velocity", {});
      if (rate) wall.table("motion").number("rate", 0.0);
    }
    return error_of([&] { c.reject_unread(); });
  };
  EXPECT_EQ(read(Config::from_text(sample, "t"), true, true), "no error");
  expect_contains(read(Config::from_text(sample, "t"), false, true),
                  "t:14: key 'wall.0.velocity': nothing in this case reads this key");
  expect_contains(read(Config::from_text(sample, "t"), true, false),
                  "t:18: key 'wall.1.motion': nothing in this case reads this table");
  expect_contains(read(Config::from_text(sample + "rad = 1\n", "t"), true, true),
                  "t:19: key 'wall.1.rad'");
  expect_contains(read(Config::from_text("tittle = 1\n" + sample, "t"), true, true),
                  "t:1: key 'tittle': nothing in this case reads this key; did you mean 'title'?");
}

TEST(ConfigUnread, nearest_or_known_names_of_the_same_table) {
  const Config c = Config::from_text("gamma = 1\n[fluid]\ngama = 2.0\n", "t");
  c.integer("gamma");
  const Config fluid = c.table("fluid");
  fluid.number("a", 1.0);
  EXPECT_EQ(error_of([&] { c.reject_unread(); }),
            "t:3: key 'fluid.gama': nothing in this case reads this key; remove it, or use one of "
            "a");
  fluid.number("gamma", 1.0);
  EXPECT_EQ(error_of([&] { fluid.reject_unread(); }),
            "t:3: key 'fluid.gama': nothing in this case reads this key; did you mean 'gamma'?");
}

TEST(ConfigUnread, asking_whether_a_key_is_there_does_not_read_it) {
  const Config c = Config::from_text("seed = 1\nsed = 2\n", "t");
  EXPECT_TRUE(c.has("seed"));
  EXPECT_EQ(error_of([&] { c.reject_unread(); }),
            "t:1: key 'seed': nothing in this case reads this key; remove it");
  c.integer("seed");
  expect_contains(error_of([&] { c.reject_unread(); }), "did you mean 'seed'?");
}

TEST(ConfigUnread, order_is_that_of_the_file) {
  const Config c = Config::from_text("z = 1\nb = 2\n[y]\n[a]\n", "t");
  expect_contains(error_of([&] { c.reject_unread(); }), "t:1: key 'z'");
  c.integer("z");
  c.integer("b");
  expect_contains(error_of([&] { c.reject_unread(); }), "t:3: key 'y'");
}

TEST(ConfigSet, values_words_and_paths) {
  const Config c = Config::from_text(
      sample, "case.toml",
      {"fluid.a=25", "solver.name=pcg", "wall.0.velocity=[2.0, 1]", "box.size.1=7.5",
       "title=\"a = b\"", " new.deep.er = true ", "file=../runs/x.h5", "fluid.n=5", "fluid.n=6"});
  EXPECT_EQ(c.table("fluid").integer("a"), 25);
  EXPECT_EQ(c.table("fluid").integer("n"), 6) << "the later one wins";
  EXPECT_EQ(c.table("solver").text("name"), "pcg");
  EXPECT_EQ(c.tables("wall").at(0).numbers("velocity"), (std::vector<double>{2.0, 1.0}));
  EXPECT_EQ(c.table("box").numbers("size"), (std::vector<double>{10.0, 7.5}));
  EXPECT_EQ(c.text("title"), "a = b");
  EXPECT_EQ(c.text("file"), "../runs/x.h5");
  EXPECT_TRUE(c.table("new").table("deep").boolean("er"));
}

TEST(ConfigSet, errors_name_the_option) {
  const auto with = [](const std::string& set) {
    return error_of([&] { Config::from_text(sample, "case.toml", {set}); });
  };
  EXPECT_EQ(with("fluid.a"), "--set fluid.a: no '=' in it: write --set key=value");
  expect_contains(with("=3"), "--set =3: no key before '='");
  expect_contains(with("fluid..a=3"), "--set fluid..a: ");
  expect_contains(with("fluid.=3"), "--set fluid.: ");
  expect_contains(with("fluid.a="), "--set fluid.a: a value is missing");
  expect_contains(with("fluid.a=[1, 2"), "--set fluid.a: '[1, 2' is not a TOML value");
  expect_contains(with("title=two words"), "--set title: 'two words' is not a TOML value");
  expect_contains(with("fluid.a=1\nb=2"), "more than one value");
  EXPECT_EQ(with("wall.2.shape=disc"),
            "--set wall.2.shape: '2' is not the index of an element of that array: 0 to 1 exist");
  expect_contains(with("wall.x=1"), "--set wall.x: 'x' is not the index");
  expect_contains(with("wall.-1.shape=disc"), "'-1' is not the index");
  EXPECT_EQ(with("fluid.a.b=1"),
            "--set fluid.a.b: 'fluid.a' is a number (18.5) and has no 'b' in it");
  expect_contains(with("include=x.toml"), "--set include: ");
}

TEST(ConfigSet, wrong_types_and_unread_keys_name_the_option) {
  const Config c = Config::from_text("[fluid]\na = 1\n", "case.toml",
                                     {"fluid.a=abc", "fluid.box={size=true}", "fluid.gama=1"});
  const Config fluid = c.table("fluid");
  EXPECT_EQ(error_of([&] { fluid.number("a"); }),
            "--set fluid.a: a number is needed, this is a string (\"abc\")");
  EXPECT_EQ(error_of([&] { fluid.table("box").number("size"); }),
            "--set fluid.box: key 'fluid.box.size': a number is needed, this is a boolean (true)");
  fluid.number("gamma", 1.0);
  EXPECT_EQ(error_of([&] { c.reject_unread(); }),
            "--set fluid.gama: nothing in this case reads this key; did you mean 'gamma'?");
  const Config lost = Config::from_text("", "case.toml", {"flui.a=1"});
  lost.table("fluid");
  EXPECT_EQ(error_of([&] { lost.reject_unread(); }),
            "--set flui.a: key 'flui': nothing in this case reads this table; did you mean "
            "'fluid'?");
}

TEST(ConfigValuesOfAnother, come_with_relative_paths_and_count_as_read) {
  const Config c = Config::from_text(R"([set]
fluid.a = 18.5
integrator = { name = "euler", dt = 1e-3 }
walls = [1, 2]
body = [{ at = [1.0, 2.0] }, { at = [3.0, 4.0] }]
[axis]
values = [0.5, "x", { label = "L", solver.name = "pcg" }]
)",
                                     "study.toml");
  EXPECT_EQ(c.values("set"),
            (odpd::ConfigValues{{"fluid.a", "18.5"},
                                {"integrator.name", "\"euler\""},
                                {"integrator.dt", "0.001"},
                                {"walls", "[1, 2]"},
                                {"body", "[{at = [1.0, 2.0]}, {at = [3.0, 4.0]}]"}}));
  EXPECT_EQ(c.table("set").values("walls"), (odpd::ConfigValues{{"", "[1, 2]"}}));
  EXPECT_TRUE(c.values("absent").empty());
  EXPECT_EQ(c.table("axis").elements("values"),
            (std::vector<odpd::ConfigValues>{
                {{"", "0.5"}}, {{"", "\"x\""}}, {{"label", "\"L\""}, {"solver.name", "\"pcg\""}}}));
  EXPECT_NE(error_of([&] { c.table("axis").elements("lost"); }).find("axis.lost"),
            std::string::npos);
  EXPECT_NE(error_of([&] { c.elements("set"); }).find("an array is needed"), std::string::npos);
  EXPECT_NO_THROW(c.reject_unread());
}

TEST(ConfigDirectory, of_a_bare_name_is_the_current_one) {
  EXPECT_EQ(Config::from_text("", "case.toml").directory(), ".");
  EXPECT_EQ(Config::from_text("", "cases/01/case.toml").directory(), "cases/01");
}

TEST(NearestName, finds_slips_and_stays_silent_otherwise) {
  const std::vector<std::string> names{"gamma", "dt", "tolerance", "size"};
  EXPECT_EQ(nearest_name("gama", names), "gamma");
  EXPECT_EQ(nearest_name("gmama", names), "gamma");
  EXPECT_EQ(nearest_name("td", names), "dt");
  EXPECT_EQ(nearest_name("tolrnace", names), "tolerance");
  EXPECT_EQ(nearest_name("tolerances", names), "tolerance");
  EXPECT_EQ(nearest_name("kT", names), "") << "two edits of two letters are another word";
  EXPECT_EQ(nearest_name("velocity", names), "");
  EXPECT_EQ(nearest_name("x", {}), "");
}

}  // namespace
