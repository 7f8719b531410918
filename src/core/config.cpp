#include "odpd/core/config.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "config_tree.h"
#include "odpd/core/error.h"

namespace odpd {

namespace {

// ---- finding

/// The given member `key`, now known and read; nullptr when the case does not give it.
const ConfigNode* read_member(ConfigNode& table, const std::string& key) {
  table.table()->asked.insert(key);
  ConfigNode* node = table.table()->find(key);
  if (!node || !node->given) return nullptr;
  node->read = true;
  return node;
}

std::string heading_text(const ConfigNode& table) {
  if (table.path.empty()) return "at the top of the file, before the first [table]";
  return table.is_element ? "under [[" + table.heading + "]]" : "under [" + table.heading + "]";
}

std::string place_of(const ConfigOrigin& at) {
  if (!at.set_key.empty()) return "--set " + at.set_key;
  return at.line > 0 ? fmt::format("{}:{}", at.file, at.line) : at.file;
}

/// A given key that nobody asked for and that looks like the missing `key`: most likely a slip.
std::string likely_slip(const ConfigTable& table, const std::string& key) {
  std::vector<std::string> strangers;
  for (const auto& [name, node] : table.members)
    if (node->given && !table.asked.contains(name)) strangers.push_back(name);
  const std::string near = nearest_name(key, strangers);
  if (near.empty()) return "";
  return fmt::format(", or correct '{}' ({})", near, place_of(table.find(near)->origin));
}

const ConfigNode& required_member(const ConfigTree& tree, ConfigNode& table,
                                  const std::string& key) {
  if (const ConfigNode* node = read_member(table, key)) return *node;
  // Of several [[elements]] the line tells which one; a plain table is found by its name.
  const ConfigOrigin at = table.is_element ? table.origin : ConfigOrigin{tree.name, 0, ""};
  throw ConfigError(fmt::format("{}: key '{}' is missing: add it {}{}", place_of(at),
                                member_path(table.path, key), heading_text(table),
                                likely_slip(*table.table(), key)));
}

// ---- values of a node

[[noreturn]] void fail_type(const ConfigNode& node, const std::string& needed) {
  fail_at(node, fmt::format("{} is needed, this is {}", needed, describe(node)));
}

double as_number(const ConfigNode& node) {
  if (const auto* whole = std::get_if<std::int64_t>(&node.value)) {
    return static_cast<double>(*whole);
  }
  const double* x = std::get_if<double>(&node.value);
  if (!x) fail_type(node, "a number");
  if (!std::isfinite(*x)) fail_at(node, "must be finite, this is " + value_text(node));
  return *x;
}

std::int64_t as_integer(const ConfigNode& node) {
  const auto* whole = std::get_if<std::int64_t>(&node.value);
  if (!whole) fail_type(node, "an integer");
  return *whole;
}

bool as_boolean(const ConfigNode& node) {
  const bool* truth = std::get_if<bool>(&node.value);
  if (!truth) fail_type(node, "true or false");
  return *truth;
}

std::string as_text(const ConfigNode& node) {
  const auto* text = std::get_if<std::string>(&node.value);
  if (!text) fail_type(node, "a string");
  return *text;
}

template <class Value>
std::vector<Value> as_list(const ConfigNode& node, Value (*element_value)(const ConfigNode&),
                           const std::string& needed) {
  const ConfigArray* array = node.array();
  if (!array) fail_type(node, needed);
  std::vector<Value> values;
  for (const auto& element : array->elements) values.push_back(element_value(*element));
  return values;
}

std::vector<double> as_numbers(const ConfigNode& node) {
  return as_list<double>(node, as_number, "an array of numbers");
}
std::vector<bool> as_booleans(const ConfigNode& node) {
  return as_list<bool>(node, as_boolean, "an array of true and false");
}
std::vector<std::string> as_texts(const ConfigNode& node) {
  return as_list<std::string>(node, as_text, "an array of strings");
}

double as_positive(const ConfigNode& node) {
  const double x = as_number(node);
  if (!(x > 0.0)) fail_at(node, "must be positive (> 0), this is " + value_text(node));
  return x;
}

double as_non_negative(const ConfigNode& node) {
  const double x = as_number(node);
  if (!(x >= 0.0)) fail_at(node, "must not be negative (>= 0), this is " + value_text(node));
  return x;
}

std::int64_t as_positive_integer(const ConfigNode& node) {
  const std::int64_t n = as_integer(node);
  if (n < 1) fail_at(node, "must be a positive integer (>= 1), this is " + value_text(node));
  return n;
}

std::string as_choice(const ConfigNode& node, const std::vector<std::string>& names) {
  std::string word = as_text(node);
  if (std::find(names.begin(), names.end(), word) != names.end()) return word;
  const std::string near = nearest_name(word, names);
  fail_at(node,
          fmt::format("must be one of {}; this is {}{}", fmt::join(names, ", "), value_text(node),
                      near.empty() ? "" : fmt::format(", did you mean '{}'?", near)));
}

// ---- defaults

ConfigValue default_value(bool value) { return value; }
ConfigValue default_value(std::int64_t value) { return value; }
ConfigValue default_value(double value) { return value; }
ConfigValue default_value(const std::string& value) { return value; }
template <class Value>
ConfigValue default_value(const std::vector<Value>& values) {
  ConfigArray array;
  for (const Value& value : values) {
    array.elements.push_back(std::make_unique<ConfigNode>());
    array.elements.back()->value = default_value(value);
  }
  return array;
}

/// The given value, else `fallback`, recorded if `convert` would accept it when read back.
template <class Value, class Convert>
Value value_or(ConfigNode& table, const std::string& key, const Value& fallback,
               const Convert& convert) {
  if (const ConfigNode* node = read_member(table, key)) return convert(*node);
  const ConfigNode* old = table.table()->find(key);
  if (old && old->table()) throw std::logic_error("configuration key is a table: " + old->path);
  auto node = std::make_unique<ConfigNode>();
  node->value = default_value(fallback);
  node->path = node->heading = member_path(table.path, key);
  node->given = false;
  try {
    convert(*node);
  } catch (const ConfigError&) {
    return fallback;
  }
  table.table()->put(key, std::move(node));
  return fallback;
}

// ---- values that are passed on

void mark_read(ConfigNode& node) {
  node.read = true;
  if (ConfigTable* table = node.table())
    for (auto& [key, below] : table->members) mark_read(*below);
  else if (ConfigArray* array = node.array())
    for (auto& element : array->elements) mark_read(*element);
}

ConfigValues values_below(ConfigNode& node) {
  mark_read(node);
  ConfigValues values = flat_values(node, true);
  for (auto& [path, text] : values) path.erase(0, std::min(path.size(), node.path.size() + 1));
  return values;
}

// ---- unread keys

std::string remedy(const std::string& key, const ConfigTable& table) {
  std::vector<std::string> known(table.asked.begin(), table.asked.end());
  std::erase(known, key);  // asked for by has() alone
  const std::string near = nearest_name(key, known);
  if (!near.empty()) return fmt::format("did you mean '{}'?", near);
  if (known.empty()) return "remove it";
  return fmt::format("remove it, or use one of {}", fmt::join(known, ", "));
}

void reject_unread_below(const ConfigNode& node) {
  if (const ConfigTable* table = node.table()) {
    for (const auto& [key, below] : table->members) {
      if (!below->given) continue;
      if (!below->read)
        fail_at(*below, fmt::format("nothing in this case reads this {}; {}",
                                    below->table() ? "table" : "key", remedy(key, *table)));
      reject_unread_below(*below);
    }
  } else if (const ConfigArray* array = node.array()) {
    for (const auto& element : array->elements) reject_unread_below(*element);
  }
}

}  // namespace

Config::Config(std::shared_ptr<ConfigTree> tree, ConfigNode* node)
    : tree_(std::move(tree)), node_(node) {}

Config Config::from_file(const std::filesystem::path& file,
                         const std::vector<std::string>& overrides) {
  std::shared_ptr<ConfigTree> tree = read_config(file, overrides);
  ConfigNode* root = &tree->root;
  return {std::move(tree), root};
}

Config Config::from_text(const std::string& text, const std::string& name,
                         const std::vector<std::string>& overrides) {
  std::shared_ptr<ConfigTree> tree = parse_config(text, name, overrides);
  ConfigNode* root = &tree->root;
  return {std::move(tree), root};
}

bool Config::has(const std::string& key) const {
  node_->table()->asked.insert(key);
  return gives(key);
}

bool Config::gives(const std::string& key) const {
  const ConfigNode* node = node_->table()->find(key);
  return node && node->given;
}

double Config::number(const std::string& key) const {
  return as_number(required_member(*tree_, *node_, key));
}
std::int64_t Config::integer(const std::string& key) const {
  return as_integer(required_member(*tree_, *node_, key));
}
bool Config::boolean(const std::string& key) const {
  return as_boolean(required_member(*tree_, *node_, key));
}
std::string Config::text(const std::string& key) const {
  return as_text(required_member(*tree_, *node_, key));
}
std::vector<double> Config::numbers(const std::string& key) const {
  return as_numbers(required_member(*tree_, *node_, key));
}
std::vector<bool> Config::booleans(const std::string& key) const {
  return as_booleans(required_member(*tree_, *node_, key));
}
std::vector<std::string> Config::texts(const std::string& key) const {
  return as_texts(required_member(*tree_, *node_, key));
}

double Config::number(const std::string& key, double fallback) const {
  return value_or(*node_, key, fallback, as_number);
}
std::int64_t Config::integer(const std::string& key, std::int64_t fallback) const {
  return value_or(*node_, key, fallback, as_integer);
}
bool Config::boolean(const std::string& key, bool fallback) const {
  return value_or(*node_, key, fallback, as_boolean);
}
std::string Config::text(const std::string& key, const std::string& fallback) const {
  return value_or(*node_, key, fallback, as_text);
}
std::vector<double> Config::numbers(const std::string& key,
                                    const std::vector<double>& fallback) const {
  return value_or(*node_, key, fallback, as_numbers);
}
std::vector<std::string> Config::texts(const std::string& key,
                                       const std::vector<std::string>& fallback) const {
  return value_or(*node_, key, fallback, as_texts);
}

double Config::positive(const std::string& key) const {
  return as_positive(required_member(*tree_, *node_, key));
}
double Config::positive(const std::string& key, double fallback) const {
  return value_or(*node_, key, fallback, as_positive);
}
double Config::non_negative(const std::string& key) const {
  return as_non_negative(required_member(*tree_, *node_, key));
}
double Config::non_negative(const std::string& key, double fallback) const {
  return value_or(*node_, key, fallback, as_non_negative);
}
std::int64_t Config::positive_integer(const std::string& key, std::int64_t fallback) const {
  return value_or(*node_, key, fallback, as_positive_integer);
}

std::string Config::choice(const std::string& key, const std::vector<std::string>& names) const {
  return as_choice(required_member(*tree_, *node_, key), names);
}
std::string Config::choice(const std::string& key, const std::vector<std::string>& names,
                           const std::string& fallback) const {
  return value_or(*node_, key, fallback,
                  [&](const ConfigNode& node) { return as_choice(node, names); });
}

Config Config::table(const std::string& key) const {
  ConfigTable& here = *node_->table();
  here.asked.insert(key);
  ConfigNode* node = here.find(key);
  if (!node) {
    auto absent = std::make_unique<ConfigNode>();
    absent->value = ConfigTable{};
    absent->origin.file = tree_->name;
    absent->path = member_path(node_->path, key);
    absent->heading = member_path(node_->heading, key);
    absent->given = false;
    node = here.put(key, std::move(absent));
  }
  if (!node->table()) fail_type(*node, fmt::format("a table ([{}])", node->heading));
  node->read = true;
  return {tree_, node};
}

std::vector<Config> Config::tables(const std::string& key) const {
  std::vector<Config> elements;
  const ConfigNode* node = read_member(*node_, key);
  if (!node) return elements;
  const std::string needed = fmt::format("an array of tables ([[{}]])", node->heading);
  if (!node->array()) fail_type(*node, needed);
  for (const auto& element : node->array()->elements) {
    if (!element->table()) fail_type(*element, "a table");
    element->read = true;
    elements.push_back({tree_, element.get()});
  }
  return elements;
}

ConfigValues Config::values(const std::string& key) const {
  ConfigNode* node = node_->table()->find(key);
  if (!read_member(*node_, key)) return {};
  return values_below(*node);
}

std::vector<ConfigValues> Config::elements(const std::string& key) const {
  const ConfigNode& node = required_member(*tree_, *node_, key);
  if (!node.array()) fail_type(node, "an array");
  std::vector<ConfigValues> list;
  for (const auto& element : node.array()->elements) list.push_back(values_below(*element));
  return list;
}

void Config::fail(const std::string& key, const std::string& message) const {
  if (key.empty()) fail_at(*node_, message);
  const ConfigNode* node = node_->table()->find(key);
  const ConfigOrigin& origin = node && node->given ? node->origin : node_->origin;
  throw ConfigError(located(origin, member_path(node_->path, key), message));
}

void Config::reject_unread() const { reject_unread_below(tree_->root); }

std::string Config::resolved() const { return document_text(tree_->root); }

ConfigValues Config::flattened() const { return flat_values(tree_->root); }

std::filesystem::path Config::directory() const { return tree_->directory; }

std::filesystem::path Config::file(const std::string& key) const {
  const std::filesystem::path path = tree_->directory / text(key);
  tree_->file_of_key[member_path(node_->path, key)] = path.string();
  return path;
}

std::string Config::file_text(const std::string& key, const std::string& remedy) const {
  const std::filesystem::path path = file(key);
  const std::string at = member_path(node_->path, key);
  if (tree_->texts_given) {
    const auto found = tree_->text_of_key.find(at);
    if (found != tree_->text_of_key.end()) return found->second;
    fail(key, "the checkpoint holds no such file: it belongs to another case");
  }
  std::string reason;
  const auto text = odpd::file_text(path, reason);
  if (!text) fail(key, fmt::format("{}: cannot be read: {}; {}", path.string(), reason, remedy));
  return tree_->text_of_key[at] = *text;
}

ConfigValues Config::files() const {
  return {tree_->file_of_key.begin(), tree_->file_of_key.end()};
}

ConfigValues Config::file_texts() const {
  return {tree_->text_of_key.begin(), tree_->text_of_key.end()};
}

void Config::use_file_texts(const ConfigValues& texts) const {
  tree_->text_of_key = {texts.begin(), texts.end()};
  tree_->texts_given = true;
}

bool is_plain_name(const std::string& word) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  };
  return !word.empty() && std::all_of(word.begin(), word.end(), plain);
}

std::string nearest_name(const std::string& word, const std::vector<std::string>& candidates) {
  // Insertions, deletions, replacements and swaps of neighbours each cost one.
  const auto distance = [&word](const std::string& other) {
    const std::size_t rows = word.size() + 1;
    const std::size_t columns = other.size() + 1;
    std::vector<std::size_t> cost(rows * columns);
    const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& {
      return cost[i * columns + j];
    };
    for (std::size_t i = 0; i < rows; ++i) at(i, 0) = i;
    for (std::size_t j = 0; j < columns; ++j) at(0, j) = j;
    for (std::size_t i = 1; i < rows; ++i) {
      for (std::size_t j = 1; j < columns; ++j) {
        const std::size_t differ = word[i - 1] == other[j - 1] ? 0 : 1;
        at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1, at(i - 1, j - 1) + differ});
        if (i > 1 && j > 1 && word[i - 1] == other[j - 2] && word[i - 2] == other[j - 1]) {
          at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
        }
      }
    }
    return cost.back();
  };
  std::string nearest;
  std::size_t least = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t d = distance(candidate);
    // As many edits as letters would make any word "near".
    if (d >= least || d >= std::max(word.size(), candidate.size())) continue;
    least = d;
    nearest = candidate;
  }
  return nearest;
}

}  // namespace odpd
