#pragma once
// A directory belongs to one running program at a time. The lock file `.odpd-run` also marks the directory as a run of
// odpd, so that nothing else is ever moved aside. The lock goes with the process, however it ends.
#include <filesystem>

namespace odpd {

class RunLock {
 public:
  /// Marks and locks an existing directory. Throws IoError when another program holds it.
  explicit RunLock(const std::filesystem::path& directory);
  ~RunLock();
  RunLock(RunLock&& other) noexcept : descriptor_(other.descriptor_) { other.descriptor_ = -1; }
  RunLock& operator=(RunLock&&) = delete;

  /// True where a run of odpd is or was.
  static bool marks(const std::filesystem::path& directory);

 private:
  int descriptor_ = -1;
};

}  // namespace odpd
