#include <gtest/gtest.h>

#include <bit>
#include <fstream>
#include <limits>

#include "io/python.h"
#include "io/temporary_directory.h"
#include "odpd/core/error.h"
#include "odpd/io/file.h"
#include "odpd/io/h5_file.h"

namespace odpd {
namespace {

using test::message_of;
using test::TemporaryDirectory;
using Doubles = std::vector<double>;
using Integers = std::vector<std::int64_t>;

Integers bits(const Doubles& values) {
  Integers result;
  for (const double value : values) result.push_back(std::bit_cast<std::int64_t>(value));
  return result;
}

TEST(H5, GivesBackBitForBit) {
  using limits = std::numeric_limits<double>;
  const TemporaryDirectory directory;
  const Doubles doubles{0.1,
                        -0.0,
                        limits::denorm_min(),
                        -limits::denorm_min(),
                        limits::max(),
                        limits::infinity(),
                        limits::quiet_NaN(),
                        std::bit_cast<double>(std::uint64_t{0xFFF8000000000123u})};
  const Integers integers{std::numeric_limits<std::int64_t>::min(), -1, 0,
                          std::numeric_limits<std::int64_t>::max()};
  H5Image image;
  image.write("/deep/down/doubles", doubles, {2, 4});
  image.write("/deep/integers", integers, {4});
  image.write("/small", std::vector<std::int32_t>{-7, 8}, {2});
  image.write("/scalar", Doubles{2.5}, {});
  image.write("/empty", Doubles{}, {0});
  image.write_text("/text", "caf\xC3\xA9\nline");
  image.write_text("/no_text", "");
  image.save(directory / "f.h5");

  const H5Reader reader(directory / "f.h5");
  EXPECT_EQ(bits(reader.read_doubles("/deep/down/doubles")), bits(doubles));
  EXPECT_EQ(reader.shape("/deep/down/doubles"), (Integers{2, 4}));
  EXPECT_EQ(bits(reader.read_doubles("/deep/down/doubles", 1)),
            bits(Doubles(doubles.begin() + 4, doubles.end())));
  EXPECT_EQ(reader.read_integers("/deep/integers"), integers);
  EXPECT_EQ(reader.read_integers("/small"), (Integers{-7, 8}));
  EXPECT_EQ(reader.read_doubles("/scalar"), Doubles{2.5});
  EXPECT_TRUE(reader.shape("/scalar").empty());
  EXPECT_TRUE(reader.read_doubles("/empty").empty());
  EXPECT_EQ(reader.read_text("/text"), "caf\xC3\xA9\nline");
  EXPECT_EQ(reader.read_text("/no_text"), "");
  EXPECT_EQ(reader.children("/deep"), (std::vector<std::string>{"down", "integers"}));
  EXPECT_TRUE(reader.has("/deep/down"));
  EXPECT_FALSE(reader.has("/deep/up/doubles"));
}

TEST(H5, RowsGrowAndLinksShareThem) {
  const TemporaryDirectory directory;
  H5Image image;
  image.create_rows("/a/step", {}, true);
  image.create_rows("/a/value", {600, 2}, false);
  image.hard_link("/a/step", "/b/step");
  for (std::int64_t k = 0; k < 1000; ++k) {
    image.append_row("/a/step", Integers{10 * k});
    if (k < 5) image.append_row("/a/value", Doubles(1200, 0.5 * static_cast<double>(k)));
    if (k == 3) image.save(directory / "early.h5");
  }
  EXPECT_THROW(image.append_row("/a/value", Doubles(1199, 0.0)), IoError);
  image.save(directory / "late.h5");
  EXPECT_GT(image.bytes(), 5 * 1200 * 8);

  EXPECT_EQ(H5Reader(directory / "early.h5").shape("/a/value"), (Integers{4, 600, 2}));
  const H5Reader late(directory / "late.h5");
  EXPECT_EQ(late.shape("/a/value"), (Integers{5, 600, 2}));
  EXPECT_EQ(late.read_doubles("/a/value", 4), Doubles(1200, 2.0));
  EXPECT_EQ(late.shape("/b/step"), Integers{1000});
  EXPECT_EQ(late.read_integers("/b/step", 999), Integers{9990});
  EXPECT_THROW(late.read_integers("/b/step", 1000), IoError);
}

TEST(H5, TheSameContentsAreTheSameBytes) {
  const TemporaryDirectory directory;
  std::string first;
  for (int k = 0; k < 2; ++k) {
    H5Image image;
    image.write("/g/x", Doubles{1.0, 2.0}, {2});
    image.attribute("/g", "names", std::vector<std::string>{"one", "three"});
    image.create_rows("/g/rows", {3}, false);
    image.append_row("/g/rows", Doubles{1.0, 2.0, 3.0});
    image.save(directory / "f.h5");
    const std::string bytes = read_file(directory / "f.h5");
    if (k == 0) first = bytes;
    EXPECT_EQ(bytes, first);
    if (k == 0) ::sleep(1);  // a time stamp would differ
  }
}

TEST(H5, AttributesReadBack) {
  const TemporaryDirectory directory;
  H5Image image;
  image.group("/g");
  image.group("/g");
  image.attribute("/g", "title", std::string("one"));
  image.attribute("/g", "names", std::vector<std::string>{"periodic", "none", ""});
  image.attribute("/g", "nobody", std::vector<std::string>{});
  image.attribute("/g", "count", std::int64_t{3});
  image.attribute("/g", "version", Integers{1, 1});
  image.save(directory / "f.h5");
  const H5Reader reader(directory / "f.h5");
  EXPECT_EQ(reader.text_attribute("/g", "title"), std::vector<std::string>{"one"});
  EXPECT_EQ(reader.text_attribute("/g", "names"),
            (std::vector<std::string>{"periodic", "none", ""}));
  EXPECT_TRUE(reader.text_attribute("/g", "nobody").empty());
  EXPECT_TRUE(reader.text_attribute("/g", "absent").empty());
  EXPECT_EQ(reader.number_attribute("/g", "count", 0.0), 3.0);
  EXPECT_EQ(reader.number_attribute("/g", "absent", 7.0), 7.0);
  EXPECT_THROW(reader.number_attribute("/g", "version", 0.0), IoError);
}

TEST(H5, WritingRefusesWhatDoesNotFit) {
  H5Image image;
  image.write("/x", Doubles{1.0}, {1});
  EXPECT_THROW(image.write("/x", Doubles{1.0}, {1}), IoError);
  EXPECT_THROW(image.write("/x/below", Doubles{1.0}, {1}), IoError);
  EXPECT_THROW(image.write("/y", Doubles{1.0, 2.0}, {3}), IoError);
  EXPECT_THROW(image.append_row("/absent", Doubles{1.0}), IoError);
  EXPECT_THROW(image.hard_link("/absent", "/z"), IoError);
}

TEST(H5, ReadersNameFileAndDataset) {
  const TemporaryDirectory directory;
  H5Image image;
  image.write("/g/doubles", Doubles{1.0}, {1});
  image.write("/g/integers", Integers{1}, {1});
  image.write_text("/g/text", "word");
  image.save(directory / "f.h5");
  const H5Reader reader(directory / "f.h5");
  const auto names = [&](const std::string& message, const std::string& dataset) {
    return message.find((directory / "f.h5").string() + ": '" + dataset + "'") == 0;
  };
  EXPECT_TRUE(names(message_of<IoError>([&] { reader.read_doubles("/absent"); }), "/absent"));
  EXPECT_TRUE(
      names(message_of<IoError>([&] { reader.read_doubles("/g/integers"); }), "/g/integers"));
  EXPECT_TRUE(names(message_of<IoError>([&] { reader.read_integers("/g/text"); }), "/g/text"));
  EXPECT_TRUE(names(message_of<IoError>([&] { reader.read_text("/g/doubles"); }), "/g/doubles"));
  EXPECT_TRUE(names(message_of<IoError>([&] { reader.read_doubles("/g"); }), "/g"));
}

TEST(H5, DamagedFilesAreRefusedByName) {
  const TemporaryDirectory directory;
  H5Image image;
  image.write("/x", Doubles(1000, 1.0), {1000});
  image.save(directory / "f.h5");
  const std::string whole = read_file(directory / "f.h5");
  const auto failure = [&](const std::string& bytes) {
    write_file_atomically(directory / "bad.h5", bytes);
    return message_of<IoError>([&] { H5Reader reader(directory / "bad.h5"); });
  };
  const std::string says =
      (directory / "bad.h5").string() + ": is not a readable HDF5 file (cut off or damaged): ";
  for (const std::size_t size : {std::size_t{0}, std::size_t{7}, std::size_t{50}, std::size_t{500},
                                 whole.size() / 2, whole.size() - 1}) {
    EXPECT_EQ(failure(whole.substr(0, size)).find(says), 0u) << size;
  }
  EXPECT_EQ(failure("step,time\n1,2\n").find(says), 0u);
  EXPECT_EQ(failure(std::string(whole.size(), '\0')).find(says), 0u);
  EXPECT_EQ(failure(whole), "");
  EXPECT_NE(
      message_of<IoError>([&] { H5Reader reader(directory / "absent.h5"); }).find("No such file"),
      std::string::npos);
}

TEST(H5, ManyImagesLiveSideBySide) {
  const TemporaryDirectory directory;
  H5Image first, second;
  first.write("/x", Doubles{1.0}, {1});
  second.write("/x", Doubles{2.0}, {1});
  first.save(directory / "1.h5");
  second.save(directory / "2.h5");
  const H5Reader one(directory / "1.h5"), two(directory / "2.h5");
  H5Image moved = std::move(first);
  moved.write("/y", Doubles{3.0}, {1});
  EXPECT_EQ(one.read_doubles("/x"), Doubles{1.0});
  EXPECT_EQ(two.read_doubles("/x"), Doubles{2.0});
}

TEST(H5, PythonReadsTextAndNumbers) {
  if (!test::python_has("h5py")) GTEST_SKIP() << "h5py is not installed";
  const TemporaryDirectory directory;
  H5Image image;
  image.write("/g/x", Doubles{0.5, -1.5}, {1, 2});
  image.write_text("/g/text", "caf\xC3\xA9");
  image.attribute("/g", "names", std::vector<std::string>{"periodic", "none"});
  image.save(directory / "f.h5");
  EXPECT_EQ(test::run_python(directory.path(), R"(
import sys, h5py
with h5py.File(sys.argv[1], 'r') as f:
    assert f['g/x'].shape == (1, 2) and f['g/x'][0, 1] == -1.5
    assert f['g/text'].asstr()[()] == 'caf\u00e9'
    assert [n.decode() for n in f['g'].attrs['names']] == ['periodic', 'none']
)",
                             directory / "f.h5"),
            0);
}

TEST(H5, ReadsTextAndNumbersOfPython) {
  if (!test::python_has("h5py")) GTEST_SKIP() << "h5py is not installed";
  const TemporaryDirectory directory;
  ASSERT_EQ(test::run_python(directory.path(), R"(
import sys, h5py, numpy as np
with h5py.File(sys.argv[1], 'w') as f:
    f['variable'] = 'caf\u00e9'
    f['fixed'] = np.bytes_('plain')
    f['single'] = np.array([0.5, 0.25], dtype='f4')
    f['big_endian'] = np.array([1, -2], dtype='>i2')
    f.attrs['names'] = ['a', 'longer']
)",
                             directory / "f.h5"),
            0);
  const H5Reader reader(directory / "f.h5");
  EXPECT_EQ(reader.read_text("/variable"), "caf\xC3\xA9");
  EXPECT_EQ(reader.read_text("/fixed"), "plain");
  EXPECT_EQ(reader.read_doubles("/single"), (Doubles{0.5, 0.25}));
  EXPECT_EQ(reader.read_integers("/big_endian"), (Integers{1, -2}));
  EXPECT_EQ(reader.text_attribute("/", "names"), (std::vector<std::string>{"a", "longer"}));
}

}  // namespace
}  // namespace odpd
