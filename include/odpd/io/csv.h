#pragma once
// CSV: small tables written whole, and time series that grow line by line and can be cut back at a
// restart.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "odpd/core/table.h"
#include "odpd/core/text_table.h"

namespace odpd {

/// Numbers have the shortest digits that read back the same. Throws IoError for ragged rows.
void write_csv(const std::filesystem::path& file, const Table& table);
/// The table in a file (core/text_table.h). Throws IoError for a missing file and what parse_csv throws.
TextTable read_csv(const std::filesystem::path& file);

/// A growing CSV file. Lines are buffered and written with checked writes by `flush`.
class SeriesFile {
 public:
  /// Starts a new file with a header.
  SeriesFile(const std::filesystem::path& file, const std::vector<std::string>& columns);
  /// Continues an existing one at `bytes`, dropping what lies beyond. Throws IoError when it is
  /// shorter.
  SeriesFile(const std::filesystem::path& file, std::int64_t bytes);
  /// Throws IoError where the constructor above would, and touches nothing.
  static void check(const std::filesystem::path& file, std::int64_t bytes);
  void append(const std::vector<double>& row);
  /// Writes what is buffered (write, checked); `sync` also fsyncs. On failure the file is cut back
  /// to the flush before, and the lines stay buffered. Nothing is flushed at the end of its life.
  void flush(bool sync = false);
  /// Length after everything appended so far is flushed.
  std::int64_t bytes() const { return bytes_ + static_cast<std::int64_t>(buffer_.size()); }

 private:
  std::filesystem::path file_;
  std::int64_t bytes_ = 0;
  std::string buffer_;
};

}  // namespace odpd
