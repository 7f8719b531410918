#pragma once
// Case files: a TOML tree whose every key must be read by somebody.
//
// A Config is a handle on one table of the tree. Reading a key marks it; reading with a default
// records the default, so that `resolved()` is the complete case. `reject_unread` makes a key that
// nobody read an error. Every error names file, line, key and remedy.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace odpd {

struct ConfigTree;
struct ConfigNode;

/// Values by their dotted path, each as TOML text.
using ConfigValues = std::vector<std::pair<std::string, std::string>>;

class Config {
 public:
  /// Reads a TOML file. `include = "other.toml"` (top level, relative to the file) is read first
  /// and overridden key by key (tables merge, arrays are replaced). `overrides` are "a.b.c=value"
  /// strings (a TOML value; a bare word is a string); errors about them name `--set a.b.c`. An
  /// array element is addressed by its index from 0: "wall.0.velocity=[1.0, 0.0]". A directory
  /// stands for the case.toml in it. Throws ConfigError (missing or malformed file, wrong override;
  /// IoError is not used here).
  static Config from_file(const std::filesystem::path& file,
                          const std::vector<std::string>& overrides = {});
  /// The same from text; `name` stands for the file in messages.
  static Config from_text(const std::string& text, const std::string& name,
                          const std::vector<std::string>& overrides = {});

  /// Whether the case gives `key`. Makes the name known, but does not count as reading it.
  bool has(const std::string& key) const;
  /// The same of a key that nobody takes here: messages do not suggest it.
  bool gives(const std::string& key) const;
  /// What the case gives there, for keys that take several kinds of values. Does not count as reading either.
  bool is_array(const std::string& key) const;
  bool is_table(const std::string& key) const;

  // Required values: ConfigError when missing, of another type, or not finite.
  double number(const std::string& key) const;  ///< a TOML integer is accepted as a number
  std::int64_t integer(const std::string& key) const;
  bool boolean(const std::string& key) const;
  std::string text(const std::string& key) const;
  std::vector<double> numbers(const std::string& key) const;
  std::vector<bool> booleans(const std::string& key) const;
  std::vector<std::string> texts(const std::string& key) const;

  // Optional values: the default is recorded in the resolved case, unless the same call would
  // refuse it when read back (infinity for "no limit", 0 for a positive number that is off).
  double number(const std::string& key, double fallback) const;
  std::int64_t integer(const std::string& key, std::int64_t fallback) const;
  bool boolean(const std::string& key, bool fallback) const;
  std::string text(const std::string& key, const std::string& fallback) const;
  std::vector<double> numbers(const std::string& key, const std::vector<double>& fallback) const;
  std::vector<std::string> texts(const std::string& key,
                                 const std::vector<std::string>& fallback) const;

  // Range-checked numbers; the message states the range.
  double positive(const std::string& key) const;
  double positive(const std::string& key, double fallback) const;
  double non_negative(const std::string& key) const;
  double non_negative(const std::string& key, double fallback) const;
  std::int64_t positive_integer(const std::string& key, std::int64_t fallback) const;

  /// A text that must be one of `names`; the error lists them and the nearest one.
  std::string choice(const std::string& key, const std::vector<std::string>& names) const;
  std::string choice(const std::string& key, const std::vector<std::string>& names,
                     const std::string& fallback) const;

  /// The sub-table `key`; an absent one reads as an empty table (its required keys then fail,
  /// named).
  Config table(const std::string& key) const;
  /// The elements of the array of tables `key` ([[key]] or key = [{...}, ...]); none when absent.
  std::vector<Config> tables(const std::string& key) const;

  // Values of keys that somebody else will read, such as those of another file.
  /// All below `key`, paths relative to it ("" for the value of `key` itself), an array of tables as one value; none when absent.
  ConfigValues values(const std::string& key) const;
  /// The same for each element of the array `key`, which is required.
  std::vector<ConfigValues> elements(const std::string& key) const;

  // Files that a case names, relative to it. Their texts are kept, so that a checkpoint can hold all that a run was made
  // from.
  /// Path of the file that `key` names. `files` lists it from then on.
  std::filesystem::path file(const std::string& key) const;
  /// The text of that file; ConfigError with `remedy` when it cannot be read.
  std::string file_text(const std::string& key, const std::string& remedy = "check the name") const;
  /// (dotted path of the key, file) of all that `file` and `file_text` were asked for.
  ConfigValues files() const;
  /// (dotted path of the key, text) of all that `file_text` gave.
  ConfigValues file_texts() const;
  /// `file_text` gives these from now on and looks at no file.
  void use_file_texts(const ConfigValues& texts) const;

  /// Throws ConfigError "FILE:LINE: key 'a.b.c': MESSAGE" (or "--set a.b.c: MESSAGE"); an empty key
  /// stands for this table. A key that the case does not give is placed at its table, or the file.
  [[noreturn]] void fail(const std::string& key, const std::string& message) const;

  /// Throws for the first key of the whole tree that nobody read, with the nearest name that was
  /// asked for in the same table. Call after everything was built.
  void reject_unread() const;

  /// The whole tree as TOML, with the defaults that were used and with includes and overrides
  /// applied.
  std::string resolved() const;

  /// Every value of the tree as (dotted path, TOML text), defaults included: to compare two cases.
  ConfigValues flattened() const;

  /// Directory of the case file: relative paths in it start there.
  std::filesystem::path directory() const;

 private:
  Config(std::shared_ptr<ConfigTree> tree, ConfigNode* node);
  std::shared_ptr<ConfigTree> tree_;  // shared by all handles: copies are cheap
  ConfigNode* node_;                  // the table in that tree
};

/// True for a word of letters, digits, _ and -: safe as part of a file name or a column.
bool is_plain_name(const std::string& word);

/// The candidate closest to `word` by edit distance, or "" when none is near (for "did you mean").
std::string nearest_name(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace odpd
