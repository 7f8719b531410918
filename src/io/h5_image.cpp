// H5Image: the writing half of h5_file.h.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numeric>
#include <span>

#include "h5_handle.h"
#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/io/file.h"
#include "odpd/io/h5_file.h"

namespace odpd {

namespace {

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw IoError(fmt::format("HDF5 image in memory: '{}' cannot be made: {}", path, what));
}

hid_t check(hid_t id, const std::string& path) {
  if (id < 0) fail(path, h5_reason());
  return id;
}

std::vector<hsize_t> extents(const std::vector<std::int64_t>& shape) {
  return {shape.begin(), shape.end()};
}

std::size_t count(const std::vector<std::int64_t>& shape) {
  return index(std::accumulate(shape.begin(), shape.end(), std::int64_t{1}, std::multiplies<>()));
}

H5Handle simple_space(const std::vector<std::int64_t>& shape) {
  if (shape.empty()) return {H5Screate(H5S_SCALAR), H5Sclose};
  const auto dims = extents(shape);
  return {H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr), H5Sclose};
}

/// Missing groups on the way to a new object are made.
H5Handle link_properties() {
  H5Handle properties(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(properties.id(), 1);
  return properties;
}

/// No time stamps: the same state gives the same bytes.
H5Handle dataset_properties() {
  H5Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties.id(), false);
  return properties;
}

H5Handle create_dataset(hid_t file, const std::string& path, hid_t type, const H5Handle& space,
                        const H5Handle& properties) {
  const H5Handle links = link_properties();
  return {check(H5Dcreate2(file, path.c_str(), type, space.id(), links.id(), properties.id(),
                           H5P_DEFAULT),
                path),
          H5Dclose};
}

void write_dataset(hid_t file, const std::string& path, hid_t stored, hid_t native,
                   const void* values, std::size_t size, const std::vector<std::int64_t>& shape) {
  if (size != count(shape)) {
    fail(path, fmt::format("{} values for the shape ({})", size, fmt::join(shape, ", ")));
  }
  const H5Handle dataset =
      create_dataset(file, path, stored, simple_space(shape), dataset_properties());
  if (size == 0) return;
  check(H5Dwrite(dataset.id(), native, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), path);
}

void write_attribute(hid_t file, const std::string& path, const std::string& name, hid_t stored,
                     hid_t native, const void* values, const std::vector<std::int64_t>& shape) {
  const H5Handle space = simple_space(shape);
  const H5Handle attribute(
      check(H5Acreate_by_name(file, path.c_str(), name.c_str(), stored, space.id(), H5P_DEFAULT,
                              H5P_DEFAULT, H5P_DEFAULT),
            path + "@" + name),
      H5Aclose);
  if (count(shape) > 0) check(H5Awrite(attribute.id(), native, values), path + "@" + name);
}

std::vector<hsize_t> dimensions(const H5Handle& dataset, const std::string& path) {
  const H5Handle space(check(H5Dget_space(dataset.id()), path), H5Sclose);
  std::vector<hsize_t> dims(index(H5Sget_simple_extent_ndims(space.id())));
  H5Sget_simple_extent_dims(space.id(), dims.data(), nullptr);
  return dims;
}

void append_to(hid_t file, const std::string& path, hid_t native, const void* row,
               std::size_t size) {
  const H5Handle dataset(check(H5Dopen2(file, path.c_str(), H5P_DEFAULT), path), H5Dclose);
  std::vector<hsize_t> dims = dimensions(dataset, path);
  const auto wanted =
      std::accumulate(dims.begin() + 1, dims.end(), hsize_t{1}, std::multiplies<>());
  if (size != wanted) fail(path, fmt::format("a row of {} values where {} fit", size, wanted));
  std::vector<hsize_t> start(dims.size(), 0);
  start.front() = dims.front();
  ++dims.front();
  check(H5Dset_extent(dataset.id(), dims.data()), path);
  dims.front() = 1;
  const H5Handle space(check(H5Dget_space(dataset.id()), path), H5Sclose);
  check(
      H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, dims.data(), nullptr),
      path);
  const H5Handle memory(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr),
                        H5Sclose);
  check(H5Dwrite(dataset.id(), native, memory.id(), space.id(), H5P_DEFAULT, row), path);
}

}  // namespace

struct H5Image::Impl {
  H5Handle file;
};

H5Image::H5Image() : impl_(std::make_unique<Impl>()) {
  silence_h5();
  const H5Handle access = h5_memory_access();
  const std::string name = h5_memory_name();
  impl_->file = H5Handle(
      check(H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), "/"), H5Fclose);
}
H5Image::H5Image(const std::filesystem::path& file)
    : impl_(std::make_unique<Impl>(Impl{open_in_memory(file, H5F_ACC_RDWR)})) {}
H5Image::~H5Image() = default;
H5Image::H5Image(H5Image&&) noexcept = default;
H5Image& H5Image::operator=(H5Image&&) noexcept = default;

void H5Image::write(const std::string& path, const std::vector<double>& values,
                    const std::vector<std::int64_t>& shape) {
  write_dataset(impl_->file.id(), path, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data(),
                values.size(), shape);
}

void H5Image::write(const std::string& path, const std::vector<std::int64_t>& values,
                    const std::vector<std::int64_t>& shape) {
  write_dataset(impl_->file.id(), path, H5T_STD_I64LE, H5T_NATIVE_INT64, values.data(),
                values.size(), shape);
}

void H5Image::write(const std::string& path, const std::vector<std::int32_t>& values,
                    const std::vector<std::int64_t>& shape) {
  write_dataset(impl_->file.id(), path, H5T_STD_I32LE, H5T_NATIVE_INT32, values.data(),
                values.size(), shape);
}

void H5Image::write_text(const std::string& path, const std::string& text) {
  const H5Handle type = h5_text_type(text.size());
  write_dataset(impl_->file.id(), path, type.id(), type.id(), text.c_str(), 1, {});
}

void H5Image::attribute(const std::string& path, const std::string& name, const std::string& text) {
  const H5Handle type = h5_text_type(text.size());
  write_attribute(impl_->file.id(), path, name, type.id(), type.id(), text.c_str(), {});
}

void H5Image::attribute(const std::string& path, const std::string& name,
                        const std::vector<std::string>& texts) {
  std::size_t length = 1;
  for (const std::string& text : texts) length = std::max(length, text.size());
  std::string padded;
  for (const std::string& text : texts) padded += text + std::string(length - text.size(), '\0');
  const H5Handle type = h5_text_type(length);
  write_attribute(impl_->file.id(), path, name, type.id(), type.id(), padded.data(),
                  {static_cast<std::int64_t>(texts.size())});
}

void H5Image::attribute(const std::string& path, const std::string& name, std::int64_t value) {
  write_attribute(impl_->file.id(), path, name, H5T_STD_I64LE, H5T_NATIVE_INT64, &value, {});
}

void H5Image::attribute(const std::string& path, const std::string& name,
                        const std::vector<std::int64_t>& values) {
  write_attribute(impl_->file.id(), path, name, H5T_STD_I64LE, H5T_NATIVE_INT64, values.data(),
                  {static_cast<std::int64_t>(values.size())});
}

void H5Image::reference(const std::string& path, const std::string& name,
                        const std::string& target) {
  hobj_ref_t value{};
  check(H5Rcreate(&value, impl_->file.id(), target.c_str(), H5R_OBJECT, -1), target);
  write_attribute(impl_->file.id(), path, name, H5T_STD_REF_OBJ, H5T_STD_REF_OBJ, &value, {});
}

void H5Image::group(const std::string& path) {
  if (H5Oexists_by_name(impl_->file.id(), path.c_str(), H5P_DEFAULT) > 0) return;
  const H5Handle links = link_properties();
  const H5Handle group(
      check(H5Gcreate2(impl_->file.id(), path.c_str(), links.id(), H5P_DEFAULT, H5P_DEFAULT), path),
      H5Gclose);
}

void H5Image::hard_link(const std::string& existing, const std::string& path) {
  const H5Handle links = link_properties();
  check(H5Lcreate_hard(impl_->file.id(), existing.c_str(), impl_->file.id(), path.c_str(),
                       links.id(), H5P_DEFAULT),
        path);
}

void H5Image::create_rows(const std::string& path, const std::vector<std::int64_t>& row_shape,
                          bool integers) {
  std::vector<hsize_t> dims = extents(row_shape);
  dims.insert(dims.begin(), 0);
  std::vector<hsize_t> limit = dims;
  limit.front() = H5S_UNLIMITED;
  // Rows of few numbers share a chunk of 4 kB; a long row is a chunk of its own.
  std::vector<hsize_t> chunk = dims;
  chunk.front() = std::max<hsize_t>(1, 512 / std::max<std::size_t>(1, count(row_shape)));
  const H5Handle space(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), limit.data()),
                       H5Sclose);
  const H5Handle properties = dataset_properties();
  check(H5Pset_chunk(properties.id(), static_cast<int>(chunk.size()), chunk.data()), path);
  create_dataset(impl_->file.id(), path, integers ? H5T_STD_I64LE : H5T_IEEE_F64LE, space,
                 properties);
}

void H5Image::append_row(const std::string& path, const std::vector<double>& row) {
  append_to(impl_->file.id(), path, H5T_NATIVE_DOUBLE, row.data(), row.size());
}

void H5Image::append_row(const std::string& path, const std::vector<std::int64_t>& row) {
  append_to(impl_->file.id(), path, H5T_NATIVE_INT64, row.data(), row.size());
}

std::int64_t H5Image::rows(const std::string& path) const {
  const H5Handle dataset(check(H5Dopen2(impl_->file.id(), path.c_str(), H5P_DEFAULT), path),
                         H5Dclose);
  return static_cast<std::int64_t>(dimensions(dataset, path).front());
}

void H5Image::keep_rows(const std::string& path, std::int64_t rows) {
  const H5Handle dataset(check(H5Dopen2(impl_->file.id(), path.c_str(), H5P_DEFAULT), path),
                         H5Dclose);
  std::vector<hsize_t> dims = dimensions(dataset, path);
  dims.front() = static_cast<hsize_t>(rows);
  check(H5Dset_extent(dataset.id(), dims.data()), path);
}

void H5Image::save(const std::filesystem::path& file) const {
  check(H5Fflush(impl_->file.id(), H5F_SCOPE_LOCAL), file.string());
  const ssize_t size = H5Fget_file_image(impl_->file.id(), nullptr, 0);
  check(size, file.string());
  std::vector<std::byte> image(index(size));
  check(H5Fget_file_image(impl_->file.id(), image.data(), image.size()), file.string());
  write_file_atomically(file, std::span<const std::byte>(image));
}

std::int64_t H5Image::bytes() const {
  hsize_t size = 0;
  check(H5Fget_filesize(impl_->file.id(), &size), "/");
  return static_cast<std::int64_t>(size);
}

}  // namespace odpd
