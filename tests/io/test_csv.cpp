#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "io/file_size_limit.h"
#include "io/temporary_directory.h"
#include "odpd/core/error.h"
#include "odpd/io/csv.h"
#include "odpd/io/file.h"

namespace odpd {
namespace {

using test::message_of;
using test::TemporaryDirectory;

TEST(Csv, NumbersSurviveBitForBit) {
  const TemporaryDirectory directory;
  using limits = std::numeric_limits<double>;
  const std::vector<double> values{0.1,
                                   -0.0,
                                   1.0 / 3.0,
                                   1e300,
                                   limits::min(),
                                   limits::max(),
                                   limits::epsilon(),
                                   123456789.0,
                                   limits::denorm_min(),
                                   limits::infinity(),
                                   -limits::infinity()};
  Table table{{"a note", "two\nlines"}, {"value", "index"}, {}};
  for (std::size_t i = 0; i < values.size(); ++i) {
    table.rows.push_back({values[i], static_cast<double>(i)});
  }
  write_csv(directory / "t.csv", table);
  const TextTable read = read_csv(directory / "t.csv");
  EXPECT_EQ(read.columns, table.columns);
  ASSERT_EQ(read.rows.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(std::strtod(read.rows[i][0].c_str(), nullptr)),
              std::bit_cast<std::uint64_t>(values[i]))
        << read.rows[i][0];
  }
  EXPECT_EQ(read.line[0], 5);  // three comment lines and the header come first
}

TEST(Csv, NotANumberHasNoSign) {
  const TemporaryDirectory directory;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  write_csv(directory / "t.csv", {{}, {"x", "y"}, {{nan, std::copysign(nan, -1.0)}}});
  EXPECT_EQ(read_file(directory / "t.csv"), "x,y\nnan,nan\n");
}

TEST(Csv, ReadsWordsSpacesAndComments) {
  const TemporaryDirectory directory;
  write_file_atomically(directory / "t.csv",
                        std::string("\xEF\xBB\xBF# made by hand\r\nx , name,y\r\n"
                                    "\n 1.5,  water , 2\n# between\n-3,oil,4"));
  const TextTable read = read_csv(directory / "t.csv");
  EXPECT_EQ(read.columns, (std::vector<std::string>{"x", "name", "y"}));
  ASSERT_EQ(read.rows.size(), 2u);
  EXPECT_EQ(read.rows[0], (std::vector<std::string>{"1.5", "water", "2"}));
  EXPECT_EQ(read.rows[1], (std::vector<std::string>{"-3", "oil", "4"}));
  EXPECT_EQ(read.line, (std::vector<std::int64_t>{4, 6}));
}

TEST(Csv, TheHeaderSaysWhatSeparatesColumns) {
  const TemporaryDirectory directory;
  const std::vector<std::string> names{"x", "name", "y"}, row{"1.5", "salt, water", "2"};
  for (const char* text :
       {"x,name,y\n1.5,\"salt, water\",2\n", "x;name;y\n1.5;salt, water;2\n",
        "x\tname\ty\n1.5\tsalt, water\t2\n", "\"x\" , \"name\",\"y\"\r\n\"1.5\",\"salt, water\", 2",
        "\"x\";\"name\";\"y\"\n1.5;\"salt, water\";2\n"}) {
    write_file_atomically(directory / "t.csv", std::string(text));
    const TextTable read = read_csv(directory / "t.csv");
    EXPECT_EQ(read.columns, names) << text;
    ASSERT_EQ(read.rows.size(), 1u) << text;
    EXPECT_EQ(read.rows[0], row) << text;
  }
  write_file_atomically(directory / "t.csv",
                        std::string("a\tb\tc\n1\t\t\n\"say \"\"no\"\"\"\t2\t3\n"));
  const TextTable read = read_csv(directory / "t.csv");
  EXPECT_EQ(read.rows[0], (std::vector<std::string>{"1", "", ""}));
  EXPECT_EQ(read.rows[1][0], "say \"no\"");
}

TEST(Csv, ColumnsAreFoundInUpperAndLowerCase) {
  const TextTable table{"t.csv", {"X", "h", "H", "r_Max", "R_max"}, {}, {}};
  EXPECT_EQ(table.find("x"), 0u);
  EXPECT_EQ(table.find("H"), 2u);
  EXPECT_EQ(table.find("h"), 1u);
  EXPECT_EQ(table.find("r_max"), std::nullopt);  // two are as near
  EXPECT_EQ(table.find("y"), std::nullopt);
  EXPECT_EQ(table.column("x", ""), 0u);
  const std::string message =
      message_of<ConfigError>([&] { table.column("y", "a start file needs x, y"); });
  EXPECT_EQ(message,
            "t.csv: there is no column 'y', its header names 'X', 'h', 'H', 'r_Max', 'R_max': a "
            "start file needs x, y");
  const TextTable spaced{"t.csv", {"x y"}, {}, {}};
  EXPECT_NE(message_of<ConfigError>([&] { spaced.column("x", ""); }).find("not by spaces"),
            std::string::npos);
}

TEST(Csv, NumbersAreFiniteWithADecimalPoint) {
  const TextTable table{"t.csv", {"x", "y"}, {{"-1e-3", "0,5"}, {"nan", "2 "}}, {3, 7}};
  EXPECT_EQ(csv_number(table, 0, 0), -1e-3);
  EXPECT_EQ(message_of<ConfigError>([&] { csv_number(table, 0, 1); }),
            "t.csv:3: column 'y': '0,5' is not a finite number: write decimals with a point");
  EXPECT_EQ(message_of<ConfigError>([&] { csv_number(table, 1, 0); }),
            "t.csv:7: column 'x': 'nan' is not a finite number");
  EXPECT_THROW(csv_number(table, 1, 1), ConfigError);
}

TEST(Csv, ErrorsNameFileAndLine) {
  const TemporaryDirectory directory;
  const auto failure = [&](const std::string& text) {
    write_file_atomically(directory / "t.csv", text);
    return message_of<IoError>([&] { read_csv(directory / "t.csv"); });
  };
  EXPECT_NE(failure("x,y\n1,2\n1,2,3\n").find("t.csv:3: 3 values"), std::string::npos);
  EXPECT_NE(failure("x,y\n1\n").find("t.csv:2: 1 values"), std::string::npos);
  EXPECT_NE(failure("").find("t.csv: is empty"), std::string::npos);
  EXPECT_NE(failure("# only this\n\n").find("t.csv: is empty"), std::string::npos);
  EXPECT_NE(failure("x;y\n1,2\n")
                .find("t.csv:2: 1 values where the header names 2 columns (x, y), "
                      "separated by semicolons"),
            std::string::npos);
  EXPECT_NE(failure("x,y\n1,\"2\n").find("t.csv:2: a quote"), std::string::npos);
  EXPECT_NE(failure("x,y\n1,\"2\"0\n").find("t.csv:2: a quote"), std::string::npos);
  // A header behind # is a comment, so the first row would pass for it.
  EXPECT_NE(failure("# x,y\n0.5,1\n1,2\n").find("t.csv:2: numbers stand where the names"),
            std::string::npos);
  EXPECT_NE(message_of<IoError>([&] { read_csv(directory / "absent.csv"); }).find("absent.csv"),
            std::string::npos);
  EXPECT_THROW(write_csv(directory / "t.csv", {{}, {"x", "y"}, {{1.0}}}), IoError);
}

TEST(Series, CountsBytesBeforeTheyAreWritten) {
  const TemporaryDirectory directory;
  SeriesFile series(directory / "s.csv", {"step", "energy"});
  EXPECT_EQ(read_file(directory / "s.csv"), "step,energy\n");
  series.append({1.0, 0.5});
  EXPECT_EQ(series.bytes(), 18);
  EXPECT_EQ(read_file(directory / "s.csv"), "step,energy\n");
  series.flush(true);
  EXPECT_EQ(series.bytes(), 18);
  EXPECT_EQ(read_file(directory / "s.csv"), "step,energy\n1,0.5\n");
  series.append({2.0, 0.25});
  series.flush();
  EXPECT_EQ(read_file(directory / "s.csv"), "step,energy\n1,0.5\n2,0.25\n");
}

TEST(Series, ResumeDropsWhatCameAfterTheCheckpoint) {
  const TemporaryDirectory directory;
  std::int64_t at_checkpoint = 0;
  {
    SeriesFile series(directory / "s.csv", {"step", "x"});
    series.append({1.0, 0.1});
    series.flush();
    at_checkpoint = series.bytes();
    series.append({2.0, 0.2});
    series.append({3.0, 0.3});
    series.flush();
  }
  const std::string uninterrupted = read_file(directory / "s.csv");
  SeriesFile resumed(directory / "s.csv", at_checkpoint);
  EXPECT_EQ(read_file(directory / "s.csv"), "step,x\n1,0.1\n");
  resumed.append({2.0, 0.2});
  resumed.append({3.0, 0.3});
  resumed.flush();
  EXPECT_EQ(read_file(directory / "s.csv"), uninterrupted);
}

TEST(Series, FullDiskLeavesWholeLinesAndCanBeRetried) {
  const TemporaryDirectory directory;
  SeriesFile series(directory / "s.csv", {"step", "x"});
  series.append({0.0, 0.5});
  series.flush();
  std::string expected = "step,x\n0,0.5\n";
  const std::string before = expected;
  for (int k = 1; k < 2000; ++k) {
    series.append({static_cast<double>(k), 0.5});
    expected += std::to_string(k) + ",0.5\n";
  }
  const std::string message = message_of<IoError>([&] {
    const test::FileSizeLimit limit(4096);
    series.flush();
  });
  EXPECT_NE(message.find("s.csv: cannot be written: File too large"), std::string::npos) << message;
  EXPECT_EQ(read_file(directory / "s.csv"), before);
  series.flush();
  EXPECT_EQ(read_file(directory / "s.csv"), expected);
}

TEST(Series, ResumeRefusesAFileThatIsTooShort) {
  const TemporaryDirectory directory;
  write_file_atomically(directory / "s.csv", std::string("step\n"));
  const std::string message =
      message_of<IoError>([&] { SeriesFile(directory / "s.csv", std::int64_t{6}); });
  EXPECT_NE(message.find("s.csv: has 5 bytes"), std::string::npos) << message;
  EXPECT_EQ(read_file(directory / "s.csv"), "step\n");
  const std::string absent =
      message_of<IoError>([&] { SeriesFile::check(directory / "absent.csv", 0); });
  EXPECT_NE(absent.find("absent.csv: is missing"), std::string::npos) << absent;
  SeriesFile::check(directory / "s.csv", 2);
  EXPECT_EQ(read_file(directory / "s.csv"), "step\n") << "only the resumed one is cut";
}

}  // namespace
}  // namespace odpd
