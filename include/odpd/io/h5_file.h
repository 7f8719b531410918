#pragma once
// HDF5 files that are either whole or absent: built in memory, then written, synced and renamed.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace odpd {

/// An HDF5 file image in memory. Paths are "/a/b/c"; groups on the way are made.
class H5Image {
 public:
  H5Image();
  /// Goes on with a file that was saved. Throws IoError when it is missing, cut off or not HDF5.
  explicit H5Image(const std::filesystem::path& file);
  ~H5Image();
  H5Image(H5Image&&) noexcept;
  H5Image& operator=(H5Image&&) noexcept;

  // Datasets of a given shape (row-major; empty shape: a scalar). Throws IoError.
  void write(const std::string& path, const std::vector<double>& values,
             const std::vector<std::int64_t>& shape);
  void write(const std::string& path, const std::vector<std::int64_t>& values,
             const std::vector<std::int64_t>& shape);
  void write(const std::string& path, const std::vector<std::int32_t>& values,
             const std::vector<std::int64_t>& shape);
  /// A scalar of fixed-length UTF-8 text (NUL bytes at its end are lost).
  void write_text(const std::string& path, const std::string& text);
  /// Attributes of an existing group or dataset: scalars, or arrays of one dimension.
  void attribute(const std::string& path, const std::string& name, const std::string& text);
  void attribute(const std::string& path, const std::string& name,
                 const std::vector<std::string>& texts);
  void attribute(const std::string& path, const std::string& name, std::int64_t value);
  void attribute(const std::string& path, const std::string& name,
                 const std::vector<std::int64_t>& values);
  /// An attribute that refers to another group or dataset.
  void reference(const std::string& path, const std::string& name, const std::string& target);
  /// Makes the group unless it is there.
  void group(const std::string& path);
  void hard_link(const std::string& existing, const std::string& path);
  /// An extendible dataset of rows of `row_shape`; rows are appended one at a time.
  void create_rows(const std::string& path, const std::vector<std::int64_t>& row_shape,
                   bool integers);
  void append_row(const std::string& path, const std::vector<double>& row);
  void append_row(const std::string& path, const std::vector<std::int64_t>& row);
  std::int64_t rows(const std::string& path) const;
  /// Drops all rows but the first `rows`.
  void keep_rows(const std::string& path, std::int64_t rows);

  /// Writes the image as it is now through write_file_atomically; more can be added afterwards.
  void save(const std::filesystem::path& file) const;
  /// Size of the image in bytes, about.
  std::int64_t bytes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads datasets of an HDF5 file. The constructor throws IoError "FILE: ..." when it is missing,
/// cut off or not HDF5; the readers when a dataset is missing or of another type.
class H5Reader {
 public:
  explicit H5Reader(const std::filesystem::path& file);
  ~H5Reader();
  H5Reader(H5Reader&&) noexcept;
  H5Reader& operator=(H5Reader&&) noexcept;

  bool has(const std::string& path) const;
  /// Names in a group, in alphabetical order; none when there is no such group.
  std::vector<std::string> children(const std::string& path) const;
  std::vector<std::int64_t> shape(const std::string& path) const;
  bool is_integer(const std::string& path) const;
  std::vector<double> read_doubles(const std::string& path) const;
  std::vector<std::int64_t> read_integers(const std::string& path) const;
  /// Row `row` along the first dimension of a dataset.
  std::vector<double> read_doubles(const std::string& path, std::int64_t row) const;
  std::vector<std::int64_t> read_integers(const std::string& path, std::int64_t row) const;
  std::string read_text(const std::string& path) const;
  /// Elements of a text attribute (one for a scalar); none when there is no such attribute.
  std::vector<std::string> text_attribute(const std::string& path, const std::string& name) const;
  /// A scalar attribute, or `fallback` when there is no such attribute.
  double number_attribute(const std::string& path, const std::string& name, double fallback) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace odpd
