#pragma once
// Tables as text, as a case may name them: CSV of numbers and words.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace odpd {

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

/// Parses a table: comments (#) and empty lines skipped, a header line first. Columns are separated
/// by what separates the header: commas or, where it has none, semicolons or tabs. Spaces around
/// words and double quotes around them are dropped. `name` stands for the file in messages. Throws
/// IoError naming file and line for a header of numbers, ragged rows, an open quote, or an empty text.
TextTable parse_csv(const std::string& text, const std::string& name);
/// A finite number with a decimal point. Throws ConfigError naming file, line and column.
double csv_number(const TextTable& table, std::size_t row, std::size_t column);

}  // namespace odpd
