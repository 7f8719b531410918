#include "odpd/io/file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

#include "descriptor.h"
#include "odpd/core/error.h"
#include "odpd/core/index.h"

namespace odpd {

namespace fs = std::filesystem;

namespace {

/// A rename is durable only once its directory is on disk.
void sync_directory(const fs::path& directory) {
  const int number = ::open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (number < 0) return;  // a directory we may write but not read: the file itself is complete
  const int result = ::fsync(number);
  const int error = errno;
  ::close(number);
  if (result != 0 && error != EINVAL && error != ENOTSUP) fail_writing(directory, error);
}

fs::path parent_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

void write_temporary(const fs::path& temporary, const fs::path& file, std::string_view text) {
  Descriptor out(temporary, O_WRONLY | O_CREAT | O_TRUNC, file);
  out.write_at(text.data(), text.size(), 0);
  out.sync();
  out.close();
}

}  // namespace

void write_file_atomically(const fs::path& file, std::string_view text) {
  const fs::path temporary = parent_of(file) / (".tmp-" + file.filename().string());
  try {
    write_temporary(temporary, file, text);
    if (std::rename(temporary.c_str(), file.c_str()) != 0) fail_writing(file, errno);
  } catch (const IoError&) {
    ::unlink(temporary.c_str());
    throw;
  }
  sync_directory(parent_of(file));
}

void write_file_atomically(const fs::path& file, std::span<const std::byte> bytes) {
  write_file_atomically(
      file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

std::string read_file(const fs::path& file) {
  const Descriptor in(file, O_RDONLY, file);
  std::string text;
  std::size_t done = 0;
  text.resize(in.size() + 1);  // one more, so that the end shows in the same call
  while (true) {
    const ssize_t count = ::read(in.number(), text.data() + done, text.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail_reading(file, errno);
    if (count == 0) break;
    done += index(count);
    if (done == text.size()) text.resize(2 * text.size());
  }
  text.resize(done);
  return text;
}

void make_directory(const fs::path& directory) {
  std::error_code error;
  fs::create_directories(directory, error);
  std::error_code status;
  if (!error && fs::is_directory(directory, status)) return;
  fail_writing(directory, error ? error.value() : EEXIST);
}

fs::path move_aside(const fs::path& directory) {
  fs::path from = directory.lexically_normal();
  if (!from.has_filename()) from = from.parent_path();  // "out/" is "out"
  std::error_code error;
  if (!fs::is_directory(from, error)) return {};
  for (int number = 1;; ++number) {
    const fs::path to = from.string() + fmt::format(".{}", number);
    if (fs::exists(fs::symlink_status(to, error))) continue;
    if (std::rename(from.c_str(), to.c_str()) == 0) return to;
    throw IoError(fmt::format("{}: cannot be moved aside to {}: {}; choose another --out",
                              from.string(), to.string(), std::generic_category().message(errno)));
  }
}

void remove_file(const fs::path& file) {
  std::error_code error;
  fs::remove(file, error);
  if (error)
    throw IoError(
        fmt::format("{}: is from after the checkpoint and cannot be removed: {}; check "
                    "permissions",
                    file.string(), error.message()));
}

}  // namespace odpd
