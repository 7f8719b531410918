#include "odpd/core/text_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "odpd/core/error.h"
#include "odpd/core/index.h"

namespace odpd {

namespace {

std::string_view stripped(std::string_view text) {
  constexpr std::string_view blank = " \t\r\n";
  const auto first = text.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

// What separates the columns of this header.
char separator_of(std::string_view header) {
  for (const char separator : {',', ';', '\t'}) {
    bool quoted = false;
    for (const char letter : header) {
      if (letter == '"') quoted = !quoted;
      if (letter == separator && !quoted) return separator;
    }
  }
  return ',';
}

const char* word_for(char separator) {
  return separator == ',' ? "commas" : separator == ';' ? "semicolons" : "tabs";
}

// Without the quotes around it, and with one for each two inside; none where its quotes are not one pair.
std::optional<std::string> unquoted(std::string_view word) {
  if (word.empty() || word.front() != '"') return std::string(word);
  if (word.size() < 2 || word.back() != '"') return {};
  std::string text;
  for (std::size_t k = 1; k + 1 < word.size(); ++k) {
    text += word[k];
    if (word[k] != '"') continue;
    if (k + 2 >= word.size() || word[k + 1] != '"') return {};
    ++k;
  }
  return text;
}

// The words of a line; none where a quote is not closed.
std::optional<std::vector<std::string>> fields(std::string_view line, char separator) {
  std::vector<std::string> result;
  for (std::size_t begin = 0; begin <= line.size();) {
    bool quoted = false;
    std::size_t end = begin;
    for (; end < line.size() && (quoted || line[end] != separator); ++end)
      if (line[end] == '"') quoted = !quoted;
    auto word = unquoted(stripped(line.substr(begin, end - begin)));
    if (!word) return {};
    result.push_back(std::move(*word));
    begin = end + 1;
  }
  return result;
}

bool is_number(const std::string& word) {
  double value = 0.0;
  return std::from_chars(word.data(), word.data() + word.size(), value).ptr ==
             word.data() + word.size() &&
         !word.empty();
}

std::string lower_case(std::string word) {
  for (char& letter : word)
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  return word;
}

// Of a file without one the first row would pass for it.
void check_header(const TextTable& table, std::int64_t number) {
  if (!std::all_of(table.columns.begin(), table.columns.end(), is_number)) return;
  throw IoError(
      fmt::format("{}:{}: numbers stand where the names of the columns are wanted ({}): begin with "
                  "a line of names, without a # before it",
                  table.file, number, fmt::join(table.columns, ", ")));
}

}  // namespace

std::optional<std::size_t> TextTable::find(const std::string& name) const {
  const auto exact = std::find(columns.begin(), columns.end(), name);
  if (exact != columns.end()) return index(exact - columns.begin());
  std::optional<std::size_t> found;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    if (lower_case(columns[k]) != lower_case(name)) continue;
    if (found) return {};
    found = k;
  }
  return found;
}

std::size_t TextTable::column(const std::string& name, const std::string& needs) const {
  if (const auto found = find(name)) return *found;
  std::string names;
  for (const std::string& each : columns)
    names += fmt::format("{}'{}'", names.empty() ? "" : ", ", each);
  const bool spaces = columns.size() == 1 && columns[0].find(' ') != std::string::npos;
  throw ConfigError(fmt::format(
      "{}: there is no column '{}', its header names {}: {}{}", file, name, names, needs,
      spaces ? "; separate columns by commas, semicolons or tabs, not by spaces" : ""));
}

TextTable parse_csv(const std::string& text, const std::string& name) {
  std::string_view rest = text;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);  // byte order mark of some editors
  TextTable table;
  table.file = name;
  char separator = ',';
  for (std::int64_t number = 1; !rest.empty(); ++number) {
    const auto end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
    const std::string_view inked = stripped(line);
    if (inked.empty() || inked.front() == '#') continue;
    const bool is_header = table.columns.empty();
    if (is_header) separator = separator_of(line);
    auto row = fields(line, separator);
    if (!row) {
      throw IoError(fmt::format("{}:{}: a quote (\") has no partner around its word: {}",
                                table.file, number, inked));
    }
    if (is_header) {
      table.columns = std::move(*row);
      check_header(table, number);
      continue;
    }
    if (row->size() != table.columns.size()) {
      throw IoError(fmt::format(
          "{}:{}: {} values where the header names {} columns ({}), separated by {}; give one "
          "value per column",
          table.file, number, row->size(), table.columns.size(), fmt::join(table.columns, ", "),
          word_for(separator)));
    }
    table.rows.push_back(std::move(*row));
    table.line.push_back(number);
  }
  if (table.columns.empty()) {
    throw IoError(fmt::format("{}: is empty; a line with the names of the columns is needed first",
                              table.file));
  }
  return table;
}

double csv_number(const TextTable& table, std::size_t row, std::size_t column) {
  const std::string& text = table.rows[row][column];
  double value = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status == std::errc{} && end == text.data() + text.size() && std::isfinite(value))
    return value;
  throw ConfigError(
      fmt::format("{}:{}: column '{}': '{}' is not a finite number{}", table.file, table.line[row],
                  table.columns[column], text,
                  text.find(',') == std::string::npos ? "" : ": write decimals with a point"));
}

}  // namespace odpd
