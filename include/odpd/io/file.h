#pragma once
// Whole files, written so that a kill or a full disk never leaves half of one.
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace odpd {

/// Writes to `.tmp-<name>` beside `file`, checks every write, fsyncs, renames over `file`, and
/// removes the temporary file on failure. Throws IoError naming the file, the system's reason and
/// the remedy (disk full, no permission, a file where a directory should be, file-size limit:
/// SIGXFSZ is ignored by main, EFBIG comes).
void write_file_atomically(const std::filesystem::path& file, std::span<const std::byte> bytes);
void write_file_atomically(const std::filesystem::path& file, std::string_view text);

/// The whole file. Throws IoError naming it.
std::string read_file(const std::filesystem::path& file);

/// Makes the directory and its parents; IoError when a file is in the way.
void make_directory(const std::filesystem::path& directory);

/// Moves an existing directory aside to `<dir>.1`, `<dir>.2`, ... (the first free name); returns
/// the new name, or "" when there was no directory to move.
std::filesystem::path move_aside(const std::filesystem::path& directory);

/// Removes what a restart writes anew; nothing when it is not there. Throws IoError.
void remove_file(const std::filesystem::path& file);

}  // namespace odpd
