#include "results.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "odpd/core/error.h"
#include "odpd/io/csv.h"
#include "odpd/io/file.h"

namespace bench {

Results::Results(std::filesystem::path file, std::vector<std::string> columns, std::size_t keys)
    : file_(std::move(file)), columns_(std::move(columns)), keys_(keys) {
  if (!std::filesystem::exists(file_)) return;
  odpd::TextTable table = odpd::read_csv(file_);
  if (table.columns != columns_)
    throw odpd::IoError(file_.string() +
                        ": holds other columns than this program writes; start anew with --fresh, "
                        "or choose another --out");
  rows_ = std::move(table.rows);
}

std::size_t Results::find(const std::vector<std::string>& key) const {
  for (std::size_t k = 0; k < rows_.size(); ++k)
    if (std::equal(key.begin(), key.end(), rows_[k].begin())) return k;
  return rows_.size();
}

bool Results::has(const std::vector<std::string>& key) const { return find(key) < rows_.size(); }

void Results::add(std::vector<std::string> row) {
  for (std::string& word : row) {
    std::replace(word.begin(), word.end(), ',', ';');
    std::replace(word.begin(), word.end(), '\n', ' ');
    if (word.empty()) word = "-";
  }
  rows_.push_back(std::move(row));
  std::string text = fmt::format("{}\n", fmt::join(columns_, ","));
  for (const auto& one : rows_) text += fmt::format("{}\n", fmt::join(one, ","));
  odpd::write_file_atomically(file_, text);
}

void Results::forget(const std::string& column, const std::vector<std::string>& words) {
  const std::size_t c = column_index(column);
  std::erase_if(rows_, [&](const auto& row) {
    return std::find(words.begin(), words.end(), row[c]) != words.end();
  });
}

std::size_t Results::column_index(const std::string& column) const {
  const auto found = std::find(columns_.begin(), columns_.end(), column);
  if (found == columns_.end()) throw odpd::ConfigError("no column " + column);
  return static_cast<std::size_t>(found - columns_.begin());
}

const std::string& Results::word(std::size_t row, const std::string& column) const {
  return rows_[row][column_index(column)];
}

double Results::number(std::size_t row, const std::string& column) const {
  const std::string& text = word(row, column);
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  return end == text.c_str() ? std::numeric_limits<double>::quiet_NaN() : value;
}

std::vector<std::string> Results::distinct(const std::string& column) const {
  std::vector<std::string> words;
  for (std::size_t k = 0; k < rows_.size(); ++k)
    if (std::find(words.begin(), words.end(), word(k, column)) == words.end())
      words.push_back(word(k, column));
  return words;
}

std::string digits(double value) {
  return std::isfinite(value) ? fmt::format("{:.4g}", value) : "-";
}

std::string markdown_row(const std::vector<std::string>& cells) {
  return fmt::format("| {} |\n", fmt::join(cells, " | "));
}

std::string markdown_head(const std::vector<std::string>& cells) {
  return markdown_row(cells) + "|" +
         fmt::format("{}\n", fmt::join(std::vector<std::string>(cells.size(), "---|"), ""));
}

}  // namespace bench
