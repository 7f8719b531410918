#include "descriptor.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "odpd/core/error.h"
#include "odpd/core/index.h"

namespace odpd {

namespace {

/// Repeats a system call as long as a signal interrupts it.
template <class Call>
auto uninterrupted(Call call) {
  auto result = call();
  while (result == -1 && errno == EINTR) result = call();
  return result;
}

const char* writing_remedy(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "free some space, or choose another --out";
    case EFBIG:
      return "raise the limit on file sizes (ulimit -f), or choose another --out";
    case EACCES:
    case EPERM:
    case EROFS:
      return "check permissions, or choose another --out";
    case EEXIST:
    case ENOTDIR:
      return "a file is in the way: remove it or choose another --out";
    case EISDIR:
    case ENOTEMPTY:
      return "a directory is in the way: remove it or choose another --out";
    case ENOENT:
      return "its directory does not exist: make it or choose another --out";
    case ENAMETOOLONG:
      return "choose a shorter --out";
    default:
      return "check the disk, or choose another --out";
  }
}

const char* reading_remedy(int error) {
  switch (error) {
    case ENOENT:
    case ENOTDIR:
      return "check the name";
    case EACCES:
    case EPERM:
      return "check permissions";
    case EISDIR:
      return "name a file, not a directory";
    default:
      return "check the disk";
  }
}

}  // namespace

void fail_writing(const std::filesystem::path& file, int error) {
  throw IoError(fmt::format("{}: cannot be written: {}; {}", file.string(),
                            std::generic_category().message(error), writing_remedy(error)));
}

void fail_reading(const std::filesystem::path& file, int error) {
  throw IoError(fmt::format("{}: cannot be read: {}; {}", file.string(),
                            std::generic_category().message(error), reading_remedy(error)));
}

Descriptor::Descriptor(const std::filesystem::path& path, int flags,
                       const std::filesystem::path& file)
    : file_(file) {
  number_ = uninterrupted([&] { return ::open(path.c_str(), flags | O_CLOEXEC, 0666); });
  if (number_ >= 0) return;
  if ((flags & O_ACCMODE) == O_RDONLY) fail_reading(file, errno);
  fail_writing(file, errno);
}

Descriptor::~Descriptor() {
  if (number_ >= 0) ::close(number_);
}

void Descriptor::write_at(const char* data, std::size_t size, std::size_t offset) const {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t count = uninterrupted([&] {
      return ::pwrite(number_, data + done, size - done, static_cast<off_t>(offset + done));
    });
    if (count < 0) fail_writing(file_, errno);
    if (count == 0) fail_writing(file_, ENOSPC);
    done += index(count);
  }
}

std::size_t Descriptor::size() const {
  struct stat status {};
  if (::fstat(number_, &status) != 0) fail_reading(file_, errno);
  return index(status.st_size);
}

void Descriptor::truncate(std::size_t size) const {
  if (uninterrupted([&] { return ::ftruncate(number_, static_cast<off_t>(size)); }) != 0) {
    fail_writing(file_, errno);
  }
}

void Descriptor::sync() const {
  // EINVAL and ENOTSUP: a file system without fsync, which is no fault of the data.
  const int result = uninterrupted([&] { return ::fsync(number_); });
  if (result != 0 && errno != EINVAL && errno != ENOTSUP) fail_writing(file_, errno);
}

void Descriptor::close() {
  const int number = number_;
  number_ = -1;
  // EINTR: Linux has released the descriptor all the same.
  if (::close(number) != 0 && errno != EINTR) fail_writing(file_, errno);
}

}  // namespace odpd
