#include <gtest/gtest.h>
#include <unistd.h>

#include "io/file_size_limit.h"
#include "io/temporary_directory.h"
#include "odpd/core/error.h"
#include "odpd/io/file.h"

namespace odpd {
namespace {

namespace fs = std::filesystem;
using test::FileSizeLimit;
using test::message_of;
using test::TemporaryDirectory;

std::size_t entries(const fs::path& directory) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(directory), fs::directory_iterator()));
}

TEST(File, GivesBackEveryByte) {
  const TemporaryDirectory directory;
  std::string bytes;
  for (int i = 0; i < 3 * 256; ++i) bytes += static_cast<char>(i % 256);
  for (const std::string& text : {std::string(), bytes, std::string(1 << 20, 'x')}) {
    write_file_atomically(directory / "a", text);
    EXPECT_EQ(read_file(directory / "a"), text);
  }
  EXPECT_EQ(entries(directory.path()), 1u);
}

TEST(File, FullDiskKeepsTheEarlierFileAndLeavesNoTemporary) {
  const TemporaryDirectory directory;
  const fs::path file = directory / "state";
  write_file_atomically(file, std::string("earlier"));
  const std::string message = message_of<IoError>([&] {
    const FileSizeLimit limit(4096);
    write_file_atomically(file, std::string(100000, 'x'));
  });
  EXPECT_NE(message.find(file.string()), std::string::npos) << message;
  EXPECT_NE(message.find("File too large"), std::string::npos) << message;
  EXPECT_NE(message.find("ulimit"), std::string::npos) << message;
  EXPECT_EQ(message.find(".tmp-"), std::string::npos) << message;
  EXPECT_EQ(read_file(file), "earlier");
  EXPECT_EQ(entries(directory.path()), 1u);
}

TEST(File, DeviceWithoutSpaceSaysFreeSomeSpace) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const TemporaryDirectory directory;
  // The temporary is a link to a device on which every write fails with ENOSPC.
  fs::create_symlink("/dev/full", directory / ".tmp-x");
  const std::string message =
      message_of<IoError>([&] { write_file_atomically(directory / "x", std::string("data")); });
  EXPECT_NE(message.find("No space left on device; free some space"), std::string::npos) << message;
  EXPECT_EQ(entries(directory.path()), 0u);
}

TEST(File, WritingNamesReasonAndRemedy) {
  const TemporaryDirectory directory;
  const auto failure = [&](const std::string& name) {
    return message_of<IoError>(
        [&] { write_file_atomically(directory / name, std::string("text")); });
  };
  EXPECT_NE(failure("absent/x").find("directory does not exist"), std::string::npos);
  write_file_atomically(directory / "plain", std::string("text"));
  EXPECT_NE(failure("plain/x").find("a file is in the way"), std::string::npos);
  fs::create_directory(directory / "folder");
  EXPECT_NE(failure("folder").find("a directory is in the way"), std::string::npos);
  EXPECT_FALSE(fs::exists(directory / ".tmp-folder"));
  if (::geteuid() == 0) return;  // root may write everywhere
  fs::permissions(directory / "folder", fs::perms::owner_read | fs::perms::owner_exec);
  EXPECT_NE(failure("folder/x").find("check permissions"), std::string::npos);
  fs::permissions(directory / "folder", fs::perms::owner_all);
}

TEST(File, ReadingNamesReasonAndRemedy) {
  const TemporaryDirectory directory;
  const auto failure = [&](const std::string& name) {
    return message_of<IoError>([&] { read_file(directory / name); });
  };
  EXPECT_NE(failure("absent").find("check the name"), std::string::npos);
  EXPECT_NE(failure("absent").find((directory / "absent").string()), std::string::npos);
  EXPECT_NE(failure("").find("name a file"), std::string::npos);
  if (::geteuid() == 0) return;
  write_file_atomically(directory / "secret", std::string("text"));
  fs::permissions(directory / "secret", fs::perms::none);
  EXPECT_NE(failure("secret").find("check permissions"), std::string::npos);
}

TEST(File, MakesDirectoriesUnlessAFileIsInTheWay) {
  const TemporaryDirectory directory;
  make_directory(directory / "a/b/c");
  make_directory(directory / "a/b/c");
  EXPECT_TRUE(fs::is_directory(directory / "a/b/c"));
  write_file_atomically(directory / "plain", std::string("text"));
  for (const char* name : {"plain", "plain/below"}) {
    const std::string message = message_of<IoError>([&] { make_directory(directory / name); });
    EXPECT_NE(message.find("a file is in the way"), std::string::npos) << message;
  }
}

TEST(File, MovesAsideToTheFirstFreeNumber) {
  const TemporaryDirectory directory;
  EXPECT_EQ(move_aside(directory / "out"), "");
  for (int number = 1; number <= 3; ++number) {
    make_directory(directory / "out");
    write_file_atomically(directory / "out" / "mark", std::to_string(number));
    const std::string name = number == 2 ? "out/" : "out";
    EXPECT_EQ(move_aside(directory / name), directory / ("out." + std::to_string(number)));
    EXPECT_FALSE(fs::exists(directory / "out"));
  }
  for (int number = 1; number <= 3; ++number) {
    EXPECT_EQ(read_file(directory / ("out." + std::to_string(number)) / "mark"),
              std::to_string(number));
  }
  fs::remove_all(directory / "out.2");
  make_directory(directory / "out");
  EXPECT_EQ(move_aside(directory / "out"), directory / "out.2");
  write_file_atomically(directory / "plain", std::string("text"));
  EXPECT_EQ(move_aside(directory / "plain"), "");
}

}  // namespace
}  // namespace odpd
