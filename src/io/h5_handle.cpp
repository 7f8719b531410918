#include "h5_handle.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>

#include "odpd/core/error.h"
#include "odpd/io/file.h"

namespace odpd {

namespace {

herr_t take_description(unsigned depth, const H5E_error2_t* error, void* text) {
  if (depth == 0 && error->desc != nullptr) *static_cast<std::string*>(text) = error->desc;
  return 0;
}

}  // namespace

std::string h5_reason() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_description, &text);
  return text.empty() ? "no reason given by HDF5" : text;
}

void silence_h5() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

H5Handle h5_memory_access() {
  constexpr std::size_t growth = std::size_t{1} << 20;
  H5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fapl_core(access.id(), growth, false);
  return access;
}

std::string h5_memory_name() {
  // HDF5 looks for a file of this name before it makes one in memory; below /dev/null is none.
  static std::atomic<unsigned> count{0};
  return "/dev/null/" + std::to_string(count++);
}

H5Handle open_in_memory(const std::filesystem::path& file, unsigned flags) {
  silence_h5();
  std::string image = read_file(file);
  const H5Handle access = h5_memory_access();
  H5Handle opened;
  if (!image.empty()) {
    H5Pset_file_image(access.id(), image.data(), image.size());
    opened = H5Handle(H5Fopen(h5_memory_name().c_str(), flags, access.id()), H5Fclose);
  }
  if (!opened)
    throw IoError(
        fmt::format("{}: is not a readable HDF5 file (cut off or damaged): {}; use an "
                    "earlier file or write it anew",
                    file.string(), image.empty() ? "it is empty" : h5_reason()));
  return opened;
}

H5Handle h5_text_type(std::size_t length) {
  H5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.id(), std::max<std::size_t>(length, 1));
  H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
  H5Tset_cset(type.id(), H5T_CSET_UTF8);
  return type;
}

}  // namespace odpd
