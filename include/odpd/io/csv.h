#pragma once
// CSV: small tables written whole, and time series that grow line by line and can be cut back at a
// restart.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "odpd/core/table.h"

namespace odpd {

/// Numbers have the shortest digits that read back the same. Throws IoError for ragged rows.
void write_csv(const std::filesystem::path& file, const Table& table);
/// A CSV of numbers and words, as text.
struct TextTable {
  std::string file;  ///< for messages
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::int64_t> line;  ///< line number of each row, for messages

  /// Place of the column `name`; where none is named so, of the only one that differs in upper and
  /// lower case alone.
  std::optional<std::size_t> find(const std::string& name) const;
  /// The same of a column that must be there; `needs` tells what this file should hold. Throws
  /// ConfigError, which says what its header names.
  std::size_t column(const std::string& name, const std::string& needs) const;
};
/// Reads a table: comments (#) and empty lines skipped, a header line first. Columns are separated
/// by what separates the header: commas or, where it has none, semicolons or tabs. Spaces around
/// words and double quotes around them are dropped. Throws IoError naming file and line for a
/// missing file, a header of numbers, ragged rows, an open quote, or an empty file.
TextTable read_csv(const std::filesystem::path& file);
/// The same of the text of a file; `name` stands for it in messages.
TextTable parse_csv(const std::string& text, const std::string& name);
/// A finite number with a decimal point. Throws ConfigError naming file, line and column.
double csv_number(const TextTable& table, std::size_t row, std::size_t column);

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
