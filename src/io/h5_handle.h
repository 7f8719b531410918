#pragma once
// Private to io: HDF5 identifiers that close themselves, and the reason HDF5 gives for a failure.
#include <hdf5.h>

#include <filesystem>
#include <string>
#include <utility>

namespace odpd {

class H5Handle {
 public:
  using Close = herr_t (*)(hid_t);
  H5Handle() = default;
  H5Handle(hid_t id, Close close) : id_(id), close_(close) {}
  ~H5Handle() { reset(); }
  H5Handle(H5Handle&& other) noexcept
      : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  H5Handle& operator=(H5Handle&& other) noexcept {
    if (this == &other) return *this;
    reset();
    id_ = std::exchange(other.id_, H5I_INVALID_HID);
    close_ = other.close_;
    return *this;
  }
  H5Handle(const H5Handle&) = delete;
  H5Handle& operator=(const H5Handle&) = delete;

  explicit operator bool() const { return id_ >= 0; }
  hid_t id() const { return id_; }

 private:
  void reset() {
    if (id_ >= 0) close_(id_);
    id_ = H5I_INVALID_HID;
  }
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

/// What HDF5 says of its last failure, at the deepest place.
std::string h5_reason();
/// HDF5 prints nothing by itself from now on: failures become IoErrors.
void silence_h5();
/// Properties of a file that lives in memory only.
H5Handle h5_memory_access();
/// A name for a file in memory: never used before, and never that of a file on disk.
std::string h5_memory_name();
/// The file on disk, read whole, to look at or to change in memory (`flags` of H5Fopen). Throws IoError when it is missing,
/// cut off or not HDF5.
H5Handle open_in_memory(const std::filesystem::path& file, unsigned flags);
/// Fixed-length UTF-8 text type of `length` bytes (at least 1).
H5Handle h5_text_type(std::size_t length);

}  // namespace odpd
