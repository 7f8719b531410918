#pragma once
// The tree behind Config: values with the place they came from, and who asked for what.
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace odpd {

struct ConfigNode;

/// Where a value was given: a line of a file (0: the file as a whole), or `--set set_key=...`.
struct ConfigOrigin {
  std::string file;
  std::uint32_t line = 0;
  std::string set_key;
};

struct ConfigDate {
  std::string text;
};

struct ConfigArray {
  std::vector<std::unique_ptr<ConfigNode>> elements;
};

struct ConfigTable {
  /// Members in the order of the file, defaults behind them.
  std::vector<std::pair<std::string, std::unique_ptr<ConfigNode>>> members;
  std::set<std::string> asked;  ///< every name somebody asked for, given or not

  ConfigNode* find(const std::string& key) const;
  /// Puts `node` at `key`, in the place of an earlier one; returns it.
  ConfigNode* put(const std::string& key, std::unique_ptr<ConfigNode> node);
};

using ConfigValue =
    std::variant<bool, std::int64_t, double, std::string, ConfigDate, ConfigArray, ConfigTable>;

struct ConfigNode {
  ConfigValue value;
  ConfigOrigin origin;
  std::string path;         ///< "a.b.0.c", "" at the root
  std::string heading;      ///< as between the brackets of a TOML header: "a.b.c" for the same
  bool is_element = false;  ///< element of an array
  bool given = true;        ///< false: a recorded default, or an absent table that was asked for
  bool read = false;

  ConfigTable* table() { return std::get_if<ConfigTable>(&value); }
  const ConfigTable* table() const { return std::get_if<ConfigTable>(&value); }
  ConfigArray* array() { return std::get_if<ConfigArray>(&value); }
  const ConfigArray* array() const { return std::get_if<ConfigArray>(&value); }
};

struct ConfigTree {
  ConfigNode root;
  std::string name;
  std::filesystem::path directory;
  std::map<std::string, std::string> file_of_key;  ///< every file that was asked for
  std::map<std::string, std::string> text_of_key;
  bool texts_given = false;  ///< text_of_key came from elsewhere, and is all there is
};

// config_parse.cpp
/// Text to tree, includes and overrides applied, all paths set.
std::unique_ptr<ConfigTree> parse_config(const std::string& text, const std::string& name,
                                         const std::vector<std::string>& overrides);
/// The text of a file, or nothing and the reason.
std::optional<std::string> file_text(const std::filesystem::path& file, std::string& reason);
std::unique_ptr<ConfigTree> read_config(const std::filesystem::path& file,
                                        const std::vector<std::string>& overrides);

// config_tree.cpp
/// `key` as TOML writes it: bare where possible, else quoted.
std::string key_text(const std::string& key);
/// Path of member `key` of a table whose own path is `path`.
std::string member_path(const std::string& path, const std::string& key);
/// Sets path and heading of everything below `node` from its own.
void set_paths(ConfigNode& node);
/// "FILE:LINE: key 'PATH': MESSAGE" and its variants.
std::string located(const ConfigOrigin& origin, const std::string& path,
                    const std::string& message);
[[noreturn]] void fail_at(const ConfigNode& node, const std::string& message);
/// "a string ("abc")", "an integer (3)", "a table", ...
std::string describe(const ConfigNode& node);
/// A value in one line of TOML; doubles read back to the same bits.
std::string value_text(const ConfigNode& node);
/// The root table and everything below it as a TOML document.
std::string document_text(const ConfigNode& root);
/// (path, value_text) of every value below `node` that is not a table, and of those of arrays of tables either one by one or,
/// with `whole_arrays`, as one value each.
std::vector<std::pair<std::string, std::string>> flat_values(const ConfigNode& node,
                                                             bool whole_arrays = false);

}  // namespace odpd
