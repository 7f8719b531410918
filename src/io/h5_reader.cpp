// H5Reader: the reading half of h5_file.h.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numeric>

#include "h5_handle.h"
#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/io/file.h"
#include "odpd/io/h5_file.h"

namespace odpd {

namespace {

std::vector<hsize_t> extents(const H5Handle& space) {
  std::vector<hsize_t> dims(index(std::max(0, H5Sget_simple_extent_ndims(space.id()))));
  H5Sget_simple_extent_dims(space.id(), dims.data(), nullptr);
  return dims;
}

std::size_t product(const std::vector<hsize_t>& dims) {
  return index(std::accumulate(dims.begin(), dims.end(), hsize_t{1}, std::multiplies<>()));
}

/// Elements of fixed or variable length, read by `read(memory type, buffer) < 0` on failure.
template <class Read>
std::vector<std::string> read_texts(hid_t stored, const H5Handle& space, Read read) {
  const auto number = index(H5Sget_simple_extent_npoints(space.id()));
  std::vector<std::string> texts;
  if (number == 0) return texts;
  if (H5Tis_variable_str(stored) > 0) {
    H5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.id(), H5T_VARIABLE);
    H5Tset_cset(type.id(), H5Tget_cset(stored));
    std::vector<char*> raw(number, nullptr);
    if (read(type.id(), raw.data()) < 0) return texts;
    for (const char* text : raw) texts.emplace_back(text == nullptr ? "" : text);
    H5Dvlen_reclaim(type.id(), space.id(), H5P_DEFAULT, raw.data());
    return texts;
  }
  const std::size_t length = H5Tget_size(stored);
  std::string raw(number * length, '\0');
  if (read(stored, raw.data()) < 0) return texts;
  const H5T_str_t padding = H5Tget_strpad(stored);
  const char filler = padding == H5T_STR_SPACEPAD ? ' ' : '\0';
  for (std::size_t i = 0; i < number; ++i) {
    std::string text = raw.substr(i * length, length);
    if (padding == H5T_STR_NULLTERM) text.resize(std::min(length, text.find('\0')));
    text.resize(text.find_last_not_of(filler) + 1);
    texts.push_back(std::move(text));
  }
  return texts;
}

}  // namespace

struct H5Reader::Impl {
  std::string name;
  H5Handle file;

  [[noreturn]] void fail(const std::string& path, const std::string& what) const {
    throw IoError(fmt::format("{}: '{}' {}", name, path, what));
  }

  H5Handle open(const std::string& path) const {
    if (H5Oexists_by_name(file.id(), path.c_str(), H5P_DEFAULT) <= 0) {
      fail(path, "is missing; is it the right file, of this version of the program?");
    }
    H5Handle dataset(H5Dopen2(file.id(), path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!dataset) fail(path, fmt::format("is no readable dataset: {}", h5_reason()));
    return dataset;
  }

  /// Opens a dataset whose type is in one of two classes, `kind` in words.
  H5Handle open(const std::string& path, H5T_class_t one, H5T_class_t other,
                const char* kind) const {
    H5Handle dataset = open(path);
    const H5Handle type(H5Dget_type(dataset.id()), H5Tclose);
    const H5T_class_t found = H5Tget_class(type.id());
    if (found != one && found != other) {
      fail(path, fmt::format("does not hold {}; is it the right file?", kind));
    }
    return dataset;
  }

  template <class T>
  std::vector<T> read_all(const std::string& path, const H5Handle& dataset, hid_t native) const {
    const H5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    std::vector<T> values(index(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space.id()))));
    if (!values.empty() &&
        H5Dread(dataset.id(), native, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) {
      fail(path, fmt::format("cannot be read: {}", h5_reason()));
    }
    return values;
  }

  template <class T>
  std::vector<T> read_row(const std::string& path, const H5Handle& dataset, hid_t native,
                          std::int64_t row) const {
    const H5Handle space(H5Dget_space(dataset.id()), H5Sclose);
    std::vector<hsize_t> dims = extents(space);
    if (dims.empty() || row < 0 || static_cast<hsize_t>(row) >= dims.front()) {
      fail(path, fmt::format("has no row {}", row));
    }
    std::vector<hsize_t> start(dims.size(), 0);
    start.front() = static_cast<hsize_t>(row);
    dims.front() = 1;
    std::vector<T> values(product(dims));
    if (values.empty()) return values;
    H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, dims.data(), nullptr);
    const H5Handle memory(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr),
                          H5Sclose);
    if (H5Dread(dataset.id(), native, memory.id(), space.id(), H5P_DEFAULT, values.data()) < 0) {
      fail(path, fmt::format("cannot be read: {}", h5_reason()));
    }
    return values;
  }

  H5Handle open_doubles(const std::string& path) const {
    return open(path, H5T_FLOAT, H5T_FLOAT, "floating-point numbers");
  }
  H5Handle open_integers(const std::string& path) const {
    return open(path, H5T_INTEGER, H5T_ENUM, "integers");
  }
  H5Handle open_attribute(const std::string& path, const std::string& attribute) const {
    if (H5Aexists_by_name(file.id(), path.c_str(), attribute.c_str(), H5P_DEFAULT) <= 0) return {};
    return {H5Aopen_by_name(file.id(), path.c_str(), attribute.c_str(), H5P_DEFAULT, H5P_DEFAULT),
            H5Aclose};
  }
};

H5Reader::H5Reader(const std::filesystem::path& file) : impl_(std::make_unique<Impl>()) {
  impl_->name = file.string();
  impl_->file = open_in_memory(file, H5F_ACC_RDONLY);
}
H5Reader::~H5Reader() = default;
H5Reader::H5Reader(H5Reader&&) noexcept = default;
H5Reader& H5Reader::operator=(H5Reader&&) noexcept = default;

bool H5Reader::has(const std::string& path) const {
  return H5Oexists_by_name(impl_->file.id(), path.c_str(), H5P_DEFAULT) > 0;
}

std::vector<std::string> H5Reader::children(const std::string& path) const {
  std::vector<std::string> names;
  if (!has(path)) return names;
  const H5Handle group(H5Gopen2(impl_->file.id(), path.c_str(), H5P_DEFAULT), H5Gclose);
  if (!group) return names;
  const auto collect = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  H5Literate(group.id(), H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names);
  return names;
}

std::vector<std::int64_t> H5Reader::shape(const std::string& path) const {
  const H5Handle dataset = impl_->open(path);
  const auto dims = extents(H5Handle(H5Dget_space(dataset.id()), H5Sclose));
  return {dims.begin(), dims.end()};
}

bool H5Reader::is_integer(const std::string& path) const {
  const H5Handle dataset = impl_->open(path);
  const H5Handle type(H5Dget_type(dataset.id()), H5Tclose);
  return H5Tget_class(type.id()) == H5T_INTEGER;
}

std::vector<double> H5Reader::read_doubles(const std::string& path) const {
  return impl_->read_all<double>(path, impl_->open_doubles(path), H5T_NATIVE_DOUBLE);
}

std::vector<std::int64_t> H5Reader::read_integers(const std::string& path) const {
  return impl_->read_all<std::int64_t>(path, impl_->open_integers(path), H5T_NATIVE_INT64);
}

std::vector<double> H5Reader::read_doubles(const std::string& path, std::int64_t row) const {
  return impl_->read_row<double>(path, impl_->open_doubles(path), H5T_NATIVE_DOUBLE, row);
}

std::vector<std::int64_t> H5Reader::read_integers(const std::string& path, std::int64_t row) const {
  return impl_->read_row<std::int64_t>(path, impl_->open_integers(path), H5T_NATIVE_INT64, row);
}

std::string H5Reader::read_text(const std::string& path) const {
  const H5Handle dataset = impl_->open(path, H5T_STRING, H5T_STRING, "text");
  const H5Handle type(H5Dget_type(dataset.id()), H5Tclose);
  const H5Handle space(H5Dget_space(dataset.id()), H5Sclose);
  const auto texts = read_texts(type.id(), space, [&](hid_t memory, void* buffer) {
    return H5Dread(dataset.id(), memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer);
  });
  if (texts.size() != 1) impl_->fail(path, fmt::format("holds {} texts, not one", texts.size()));
  return texts.front();
}

std::vector<std::string> H5Reader::text_attribute(const std::string& path,
                                                  const std::string& name) const {
  const H5Handle attribute = impl_->open_attribute(path, name);
  if (!attribute) return {};
  const H5Handle type(H5Aget_type(attribute.id()), H5Tclose);
  if (H5Tget_class(type.id()) != H5T_STRING) impl_->fail(path + "@" + name, "does not hold text");
  const H5Handle space(H5Aget_space(attribute.id()), H5Sclose);
  return read_texts(type.id(), space, [&](hid_t memory, void* buffer) {
    return H5Aread(attribute.id(), memory, buffer);
  });
}

double H5Reader::number_attribute(const std::string& path, const std::string& name,
                                  double fallback) const {
  const H5Handle attribute = impl_->open_attribute(path, name);
  if (!attribute) return fallback;
  const H5Handle space(H5Aget_space(attribute.id()), H5Sclose);
  double value = fallback;
  if (H5Sget_simple_extent_npoints(space.id()) != 1 ||
      H5Aread(attribute.id(), H5T_NATIVE_DOUBLE, &value) < 0) {
    impl_->fail(path + "@" + name, "does not hold one number");
  }
  return value;
}

}  // namespace odpd
