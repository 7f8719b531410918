#pragma once
// Results that grow row by row in a CSV file, so that an interrupted benchmark goes on where it was.
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace bench {

class Results {
 public:
  /// Reads what the file holds already; the first `keys` columns name a row. Throws IoError when it holds other
  /// columns.
  Results(std::filesystem::path file, std::vector<std::string> columns, std::size_t keys);

  bool has(const std::vector<std::string>& key) const;
  /// Appends a row and writes the file; commas in words become semicolons.
  void add(std::vector<std::string> row);

  /// Drops the rows with one of these words in a column; the file changes at the next `add`.
  void forget(const std::string& column, const std::vector<std::string>& words);

  std::size_t size() const { return rows_.size(); }
  std::size_t columns() const { return columns_.size(); }
  const std::string& word(std::size_t row, const std::string& column) const;
  double number(std::size_t row, const std::string& column) const;  ///< NaN where there is none
  /// Different words of a column, in order of appearance.
  std::vector<std::string> distinct(const std::string& column) const;
  /// Index of the row of these keys, size() where there is none.
  std::size_t find(const std::vector<std::string>& key) const;

 private:
  std::size_t column_index(const std::string& column) const;

  std::filesystem::path file_;
  std::vector<std::string> columns_;
  std::size_t keys_;
  std::vector<std::vector<std::string>> rows_;
};

/// Four significant digits; "-" for what is not finite.
std::string digits(double value);
/// One markdown row.
std::string markdown_row(const std::vector<std::string>& cells);
/// Header and rule.
std::string markdown_head(const std::vector<std::string>& cells);

}  // namespace bench
