#pragma once
// Private to io: checked system calls on files, and the one place that words their failures.
#include <cstddef>
#include <filesystem>
#include <string>

namespace odpd {

/// An open file descriptor; closed at the end of its life.
class Descriptor {
 public:
  /// Opens `path` as ::open does. Failures are worded for reading or writing, after `flags`, and
  /// name `file`: what the user calls it where `path` is a temporary.
  Descriptor(const std::filesystem::path& path, int flags, const std::filesystem::path& file);
  ~Descriptor();
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  /// Everything from `data` is written at `offset`, or IoError is thrown.
  void write_at(const char* data, std::size_t size, std::size_t offset) const;
  std::size_t size() const;
  void truncate(std::size_t size) const;
  void sync() const;
  /// Closes now, so that an error the system reports only then is not lost.
  void close();
  int number() const { return number_; }

 private:
  std::filesystem::path file_;
  int number_ = -1;
};

/// Throws IoError "FILE: cannot be written: REASON; REMEDY" for an errno value.
[[noreturn]] void fail_writing(const std::filesystem::path& file, int error);
/// Throws IoError "FILE: cannot be read: REASON; REMEDY" for an errno value.
[[noreturn]] void fail_reading(const std::filesystem::path& file, int error);

}  // namespace odpd
