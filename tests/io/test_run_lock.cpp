#include <gtest/gtest.h>

#include <filesystem>
#include <optional>

#include "odpd/core/error.h"
#include "odpd/io/run_lock.h"

namespace odpd {
namespace {

TEST(RunLock, OneHolderAtATime) {
  const auto directory =
      std::filesystem::temp_directory_path() / ("odpd-lock-" + std::to_string(getpid()));
  std::filesystem::create_directory(directory);
  EXPECT_FALSE(RunLock::marks(directory));
  {
    std::optional<RunLock> first(directory);
    EXPECT_TRUE(RunLock::marks(directory));
    EXPECT_THROW(RunLock{directory}, IoError);
    first.reset();
    EXPECT_NO_THROW(RunLock{directory}) << "free again";
  }
  EXPECT_TRUE(RunLock::marks(directory)) << "the mark of a run stays";
  std::filesystem::remove_all(directory);
}

TEST(RunLock, NeedsADirectory) { EXPECT_THROW(RunLock{"/nowhere/at/all"}, IoError); }

}  // namespace
}  // namespace odpd
