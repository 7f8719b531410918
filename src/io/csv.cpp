#include "odpd/io/csv.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <iterator>

#include "descriptor.h"
#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/io/file.h"

namespace odpd {

namespace {

std::string header_line(const std::vector<std::string>& columns) {
  return fmt::format("{}\n", fmt::join(columns, ","));
}

/// The shortest digits that read back as the same number.
void append_line(std::string& out, const std::vector<double>& row) {
  const char* separator = "";
  for (const double value : row) {
    out += separator;
    // The sign of a NaN depends on the processor; it means nothing.
    if (std::isnan(value)) {
      out += "nan";
    } else {
      fmt::format_to(std::back_inserter(out), "{}", value);
    }
    separator = ",";
  }
  out += '\n';
}

}  // namespace

void write_csv(const std::filesystem::path& file, const Table& table) {
  std::string text;
  for (const std::string& comment : table.comment) {
    text += "# ";
    for (const char letter : comment) {
      text += letter;
      if (letter == '\n') text += "# ";
    }
    text += '\n';
  }
  text += header_line(table.columns);
  for (const auto& row : table.rows) {
    if (row.size() != table.columns.size()) {
      throw IoError(fmt::format("{}: cannot be written: a row of {} values for {} columns ({})",
                                file.string(), row.size(), table.columns.size(),
                                fmt::join(table.columns, ",")));
    }
    append_line(text, row);
  }
  write_file_atomically(file, text);
}

TextTable read_csv(const std::filesystem::path& file) {
  return parse_csv(read_file(file), file.string());
}

SeriesFile::SeriesFile(const std::filesystem::path& file, const std::vector<std::string>& columns)
    : file_(file) {
  const std::string header = header_line(columns);
  write_file_atomically(file_, header);
  bytes_ = static_cast<std::int64_t>(header.size());
}

SeriesFile::SeriesFile(const std::filesystem::path& file, std::int64_t bytes)
    : file_(file), bytes_(bytes) {
  check(file, bytes);
  Descriptor(file_, O_WRONLY, file_).truncate(index(bytes));
}

void SeriesFile::check(const std::filesystem::path& file, std::int64_t bytes) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored))
    throw IoError(
        fmt::format("{}: is missing, and the checkpoint continues it from byte {}: restore it, or "
                    "continue into a new directory with --out",
                    file.string(), bytes));
  const Descriptor out(file, O_WRONLY, file);
  if (out.size() < index(bytes))
    throw IoError(
        fmt::format("{}: has {} bytes where the checkpoint knows {}: it was cut or replaced since; "
                    "restore it, or continue into a new directory with --out",
                    file.string(), out.size(), bytes));
}

void SeriesFile::append(const std::vector<double>& row) { append_line(buffer_, row); }

void SeriesFile::flush(bool sync) {
  if (buffer_.empty() && !sync) return;
  Descriptor out(file_, O_WRONLY, file_);
  try {
    out.write_at(buffer_.data(), buffer_.size(), index(bytes_));
    if (sync) out.sync();
    out.close();
  } catch (const IoError&) {
    // Half a line would be read as a number: cut back to the last whole flush.
    std::error_code ignored;
    std::filesystem::resize_file(file_, static_cast<std::uintmax_t>(bytes_), ignored);
    throw;
  }
  bytes_ += static_cast<std::int64_t>(buffer_.size());
  buffer_.clear();
}

}  // namespace odpd
