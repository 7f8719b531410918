#include "config_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "odpd/core/config.h"
#include "odpd/core/error.h"

namespace odpd {

namespace {

bool is_bare_key(const std::string& key) {
  return !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (c == '\n') {
      out += "\\n";
    } else if (c == '\t') {
      out += "\\t";
    } else if (code < 0x20 || code == 0x7f) {
      out += fmt::format("\\u{:04X}", static_cast<unsigned>(code));
    } else {
      out += c;
    }
  }
  return out + '"';
}

std::string number_text(double x) {
  if (std::isnan(x)) return "nan";
  if (std::isinf(x)) return x > 0.0 ? "inf" : "-inf";
  std::string text = fmt::format("{}", x);  // the shortest digits that read back to the same bits
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

// Members that stand in the document: all that were given, and defaults that were recorded.
bool is_written(const ConfigNode& node) {
  const ConfigTable* table = node.table();
  if (node.given || !table) return true;
  return std::any_of(table->members.begin(), table->members.end(),
                     [](const auto& member) { return is_written(*member.second); });
}

bool is_array_of_tables(const ConfigNode& node) {
  const ConfigArray* array = node.array();
  return array && !array->elements.empty() &&
         std::all_of(array->elements.begin(), array->elements.end(),
                     [](const auto& element) { return element->table() != nullptr; });
}

std::string table_text(const ConfigTable& table) {
  std::string out;
  for (const auto& [key, node] : table.members) {
    if (!is_written(*node)) continue;
    out += fmt::format("{}{} = {}", out.empty() ? "" : ", ", key_text(key), value_text(*node));
  }
  return "{" + out + "}";
}

std::string array_text(const ConfigArray& array) {
  std::string out;
  for (const auto& element : array.elements) {
    out += fmt::format("{}{}", out.empty() ? "" : ", ", value_text(*element));
  }
  return "[" + out + "]";
}

void write_header(const char* open, const ConfigNode& node, const char* close, std::string& out) {
  if (!out.empty()) out += '\n';
  out += open + node.heading + close + '\n';
}

// TOML wants the plain values of a table before the headers of its sub-tables.
void write_members(const ConfigTable& table, std::string& out) {
  for (const auto& [key, node] : table.members) {
    if (node->table() || is_array_of_tables(*node)) continue;
    out += fmt::format("{} = {}\n", key_text(key), value_text(*node));
  }
  for (const auto& [key, node] : table.members) {
    if (const ConfigTable* below = node->table(); below && is_written(*node)) {
      write_header("[", *node, "]", out);
      write_members(*below, out);
    } else if (is_array_of_tables(*node)) {
      for (const auto& element : node->array()->elements) {
        write_header("[[", *element, "]]", out);
        write_members(*element->table(), out);
      }
    }
  }
}

}  // namespace

ConfigNode* ConfigTable::find(const std::string& key) const {
  for (const auto& [name, node] : members) {
    if (name == key) return node.get();
  }
  return nullptr;
}

ConfigNode* ConfigTable::put(const std::string& key, std::unique_ptr<ConfigNode> node) {
  for (auto& [name, old] : members) {
    if (name != key) continue;
    old = std::move(node);
    return old.get();
  }
  return members.emplace_back(key, std::move(node)).second.get();
}

std::string key_text(const std::string& key) { return is_bare_key(key) ? key : quoted(key); }

std::string member_path(const std::string& path, const std::string& key) {
  return path.empty() ? key_text(key) : path + "." + key_text(key);
}

void set_paths(ConfigNode& node) {
  if (ConfigTable* table = node.table()) {
    for (auto& [key, below] : table->members) {
      below->path = member_path(node.path, key);
      below->heading = member_path(node.heading, key);
      set_paths(*below);
    }
  } else if (ConfigArray* array = node.array()) {
    for (std::size_t k = 0; k < array->elements.size(); ++k) {
      ConfigNode& element = *array->elements[k];
      element.path = fmt::format("{}.{}", node.path, k);
      element.heading = node.heading;
      element.is_element = true;
      set_paths(element);
    }
  }
}

std::string located(const ConfigOrigin& origin, const std::string& path,
                    const std::string& message) {
  std::string place;
  if (!origin.set_key.empty()) {
    place = "--set " + origin.set_key;
    if (origin.set_key == path) return place + ": " + message;
  } else {
    place = origin.line > 0 ? fmt::format("{}:{}", origin.file, origin.line) : origin.file;
  }
  if (path.empty()) return place + ": " + message;
  return fmt::format("{}: key '{}': {}", place, path, message);
}

void fail_at(const ConfigNode& node, const std::string& message) {
  throw ConfigError(located(node.origin, node.path, message));
}

std::string describe(const ConfigNode& node) {
  if (node.table()) return "a table";
  if (node.array()) return is_array_of_tables(node) ? "an array of tables" : "an array";
  constexpr const char* names[] = {"a boolean", "an integer", "a number", "a string", "a date"};
  return fmt::format("{} ({})", names[node.value.index()], value_text(node));
}

std::string value_text(const ConfigNode& node) {
  return std::visit(
      [](const auto& value) -> std::string {
        using Value = std::decay_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, double>) {
          return number_text(value);
        } else if constexpr (std::is_same_v<Value, std::string>) {
          return quoted(value);
        } else if constexpr (std::is_same_v<Value, ConfigDate>) {
          return value.text;
        } else if constexpr (std::is_same_v<Value, ConfigArray>) {
          return array_text(value);
        } else if constexpr (std::is_same_v<Value, ConfigTable>) {
          return table_text(value);
        } else {
          return fmt::format("{}", value);
        }
      },
      node.value);
}

std::string document_text(const ConfigNode& root) {
  std::string out;
  write_members(*root.table(), out);
  return out;
}

std::vector<std::pair<std::string, std::string>> flat_values(const ConfigNode& node,
                                                             bool whole_arrays) {
  std::vector<std::pair<std::string, std::string>> values;
  const auto descend = [&](const ConfigNode& below) {
    const auto more = flat_values(below, whole_arrays);
    values.insert(values.end(), more.begin(), more.end());
  };
  if (const ConfigTable* table = node.table()) {
    for (const auto& [key, below] : table->members) descend(*below);
  } else if (!whole_arrays && is_array_of_tables(node)) {
    for (const auto& element : node.array()->elements) descend(*element);
  } else {
    values.emplace_back(node.path, value_text(node));
  }
  return values;
}

bool Config::is_array(const std::string& key) const {
  return has(key) && node_->table()->find(key)->array() != nullptr;
}
bool Config::is_table(const std::string& key) const {
  return has(key) && node_->table()->find(key)->table() != nullptr;
}

}  // namespace odpd
