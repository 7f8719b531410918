#include "odpd/io/run_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "odpd/core/error.h"

namespace odpd {

namespace {
constexpr const char* marker = ".odpd-run";
}  // namespace

RunLock::RunLock(const std::filesystem::path& directory) {
  const std::string file = (directory / marker).string();
  descriptor_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0)
    throw IoError(
        fmt::format("{}: cannot be written: {}; check permissions or choose another --out", file,
                    std::strerror(errno)));
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  ::close(descriptor_);
  throw IoError(fmt::format(
      "{}: another odpd is running in this directory; wait for it or choose another --out",
      directory.string()));
}

RunLock::~RunLock() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

bool RunLock::marks(const std::filesystem::path& directory) {
  return std::filesystem::exists(directory / marker);
}

}  // namespace odpd
