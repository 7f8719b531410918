#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "io/file_size_limit.h"
#include "io/temporary_directory.h"
#include "odpd/core/error.h"
#include "odpd/io/checkpoint_file.h"
#include "odpd/io/file.h"

namespace odpd {
namespace {

using test::message_of;
using test::TemporaryDirectory;
using Doubles = std::vector<double>;
using Integers = std::vector<std::int64_t>;

void write_sample(const std::filesystem::path& file) {
  CheckpointWriter writer;
  StateWriter& particles = writer.component("particles");
  StateWriter& observer = writer.component("observer/0");
  particles.write("position", Doubles{-0.0, std::numeric_limits<double>::denorm_min(), 3.0});
  observer.write("count", Integers{1, -2});
  particles.write("nothing", Doubles{});
  particles.write("pair_list/reference", Integers{});
  particles.write_text("order", "spatial");
  writer.component("stateless");
  writer.save(file);
}

TEST(Checkpoint, ComponentsGetTheirOwnStateBack) {
  const TemporaryDirectory directory;
  write_sample(directory / "checkpoint.h5");
  CheckpointReader reader(directory / "checkpoint.h5");
  StateReader& particles = reader.component("particles");
  StateReader& observer = reader.component("observer/0");
  const Doubles position = particles.read_doubles("position");
  ASSERT_EQ(position.size(), 3u);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(position[0]), std::uint64_t{1} << 63);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(position[1]), 1u);
  EXPECT_EQ(position[2], 3.0);
  EXPECT_TRUE(particles.read_doubles("nothing").empty());
  EXPECT_TRUE(particles.read_integers("pair_list/reference").empty());
  EXPECT_EQ(particles.read_text("order"), "spatial");
  EXPECT_EQ(observer.read_integers("count"), (Integers{1, -2}));
  EXPECT_TRUE(particles.has("position"));
  EXPECT_FALSE(observer.has("position"));
  EXPECT_TRUE(reader.has("stateless"));
  EXPECT_TRUE(reader.has("observer/0"));
  EXPECT_FALSE(reader.has("observer/1"));
}

TEST(Checkpoint, MissingNamesAndWrongTypesAreNamed) {
  const TemporaryDirectory directory;
  const auto file = directory / "checkpoint.h5";
  write_sample(file);
  CheckpointReader reader(file);
  StateReader& particles = reader.component("particles");
  const auto contains = [&](const std::string& message, const std::string& name) {
    return message.find(file.string()) == 0 && message.find(name) != std::string::npos;
  };
  EXPECT_TRUE(contains(message_of<IoError>([&] { particles.read_doubles("mass"); }), "'mass'"));
  EXPECT_TRUE(
      contains(message_of<IoError>([&] { particles.read_integers("position"); }), "position"));
  EXPECT_TRUE(contains(message_of<IoError>([&] { particles.read_doubles("order"); }), "order"));
  EXPECT_TRUE(contains(message_of<IoError>([&] { particles.read_text("nothing"); }), "nothing"));
  EXPECT_TRUE(contains(message_of<IoError>([&] { reader.component("walls"); }), "'walls'"));
}

TEST(Checkpoint, ANameIsWrittenOnce) {
  CheckpointWriter writer;
  StateWriter& component = writer.component("particles");
  component.write("x", Doubles{1.0});
  EXPECT_THROW(component.write("x", Doubles{2.0}), IoError);
}

TEST(Checkpoint, FullDiskKeepsTheEarlierOne) {
  const TemporaryDirectory directory;
  write_sample(directory / "checkpoint.h5");
  const std::string earlier = read_file(directory / "checkpoint.h5");
  CheckpointWriter writer;
  writer.component("particles").write("x", Doubles(100000, 1.0));
  EXPECT_THROW(
      {
        const test::FileSizeLimit limit(65536);
        writer.save(directory / "checkpoint.h5");
      },
      IoError);
  EXPECT_EQ(read_file(directory / "checkpoint.h5"), earlier);
  writer.save(directory / "checkpoint.h5");
  CheckpointReader reader(directory / "checkpoint.h5");
  EXPECT_EQ(reader.component("particles").read_doubles("x"), Doubles(100000, 1.0));
}

TEST(Checkpoint, OtherFilesAreRefused) {
  const TemporaryDirectory directory;
  const auto failure = [&](const std::string& name) {
    return message_of<IoError>([&] { CheckpointReader reader(directory / name); });
  };
  H5Image image;
  image.write("/x", Doubles{1.0}, {1});
  image.save(directory / "other.h5");
  EXPECT_NE(failure("other.h5").find("is no odpd checkpoint"), std::string::npos);
  H5Image later;
  later.write("/odpd_checkpoint_format", Integers{99}, {});
  later.save(directory / "later.h5");
  EXPECT_NE(failure("later.h5").find("format 99"), std::string::npos);
  write_sample(directory / "checkpoint.h5");
  const std::string whole = read_file(directory / "checkpoint.h5");
  write_file_atomically(directory / "cut.h5", whole.substr(0, whole.size() - 100));
  EXPECT_NE(failure("cut.h5").find("cut off or damaged"), std::string::npos);
}

}  // namespace
}  // namespace odpd
