#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>

#include "config_tree.h"
#include "odpd/core/error.h"

namespace odpd {

namespace {

namespace fs = std::filesystem;

// ---- from toml++ to our tree

template <class Date>
ConfigValue date_value(const Date& date) {
  std::ostringstream text;
  text << date;
  return ConfigDate{text.str()};
}

std::unique_ptr<ConfigNode> converted(const toml::node& source, const ConfigOrigin& origin);

ConfigTable converted_table(const toml::table& source, const ConfigOrigin& origin) {
  std::vector<std::pair<const toml::key*, const toml::node*>> members;
  for (const auto& [key, node] : source) members.emplace_back(&key, &node);
  // toml++ sorts by name; the order of the file is the one its reader knows.
  std::stable_sort(members.begin(), members.end(), [](const auto& a, const auto& b) {
    return a.first->source().begin < b.first->source().begin;
  });
  ConfigTable table;
  for (const auto& [key, node] : members) {
    ConfigOrigin place = origin;
    if (place.set_key.empty()) place.line = key->source().begin.line;
    table.members.emplace_back(std::string(key->str()), converted(*node, place));
  }
  return table;
}

ConfigArray converted_array(const toml::array& source, const ConfigOrigin& origin) {
  ConfigArray array;
  for (const toml::node& element : source) {
    ConfigOrigin place = origin;
    const std::uint32_t line = element.source().begin.line;
    if (place.set_key.empty() && line > 0) place.line = line;
    array.elements.push_back(converted(element, place));
  }
  return array;
}

ConfigValue converted_value(const toml::node& source, const ConfigOrigin& origin) {
  switch (source.type()) {
    case toml::node_type::table:
      return converted_table(*source.as_table(), origin);
    case toml::node_type::array:
      return converted_array(*source.as_array(), origin);
    case toml::node_type::string:
      return source.as_string()->get();
    case toml::node_type::integer:
      return source.as_integer()->get();
    case toml::node_type::floating_point:
      return source.as_floating_point()->get();
    case toml::node_type::boolean:
      return source.as_boolean()->get();
    case toml::node_type::date:
      return date_value(source.as_date()->get());
    case toml::node_type::time:
      return date_value(source.as_time()->get());
    default:
      return date_value(source.as_date_time()->get());
  }
}

std::unique_ptr<ConfigNode> converted(const toml::node& source, const ConfigOrigin& origin) {
  auto node = std::make_unique<ConfigNode>();
  node->value = converted_value(source, origin);
  node->origin = origin;
  return node;
}

std::unique_ptr<ConfigNode> parse_document(const std::string& text, const std::string& name) {
  try {
    return converted(toml::parse(text, name), {name, 0, ""});
  } catch (const toml::parse_error& error) {
    const toml::source_position at = error.source().begin;
    throw ConfigError(
        fmt::format("{}:{}:{}: not valid TOML: {}", name, at.line, at.column, error.description()));
  }
}

// ---- files and includes

fs::path case_file(const fs::path& given) {
  std::error_code ignored;
  return fs::is_directory(given, ignored) ? given / "case.toml" : given;
}

fs::path directory_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

fs::path identity(const fs::path& file) {
  std::error_code error;
  fs::path whole = fs::weakly_canonical(file, error);
  return error ? file : whole;
}

void merge(ConfigTable& base, ConfigTable& over) {
  for (auto& [key, node] : over.members) {
    ConfigNode* old = base.find(key);
    if (old && old->table() && node->table()) {
      old->origin = node->origin;
      merge(*old->table(), *node->table());
    } else {
      base.put(key, std::move(node));
    }
  }
}

std::unique_ptr<ConfigNode> take(ConfigTable& table, const std::string& key) {
  for (auto member = table.members.begin(); member != table.members.end(); ++member) {
    if (member->first != key) continue;
    std::unique_ptr<ConfigNode> node = std::move(member->second);
    table.members.erase(member);
    return node;
  }
  return nullptr;
}

/// Parses `text` over what it includes; `chain` holds the files that led here, itself the last.
std::unique_ptr<ConfigNode> load(const std::string& text, const fs::path& file,
                                 const std::vector<fs::path>& chain) {
  std::unique_ptr<ConfigNode> root = parse_document(text, file.string());
  const std::unique_ptr<ConfigNode> include = take(*root->table(), "include");
  if (!include) return root;
  include->path = "include";
  const std::string* name = std::get_if<std::string>(&include->value);
  if (!name) fail_at(*include, "the name of a file is needed, this is " + describe(*include));
  const fs::path included = case_file((directory_of(file) / *name).lexically_normal());
  const auto seen = std::find(chain.begin(), chain.end(), identity(included));
  if (seen != chain.end()) {
    std::string loop;
    for (auto link = seen; link != chain.end(); ++link) loop += link->string() + " -> ";
    fail_at(*include, "files include each other in a circle: " + loop + seen->string() +
                          "; remove one of these includes");
  }
  std::string reason;
  const std::optional<std::string> base_text = file_text(included, reason);
  if (!base_text) {
    fail_at(*include,
            fmt::format("{} cannot be read: {}; the name is relative to the file it stands in",
                        included.string(), reason));
  }
  std::vector<fs::path> longer = chain;
  longer.push_back(identity(included));
  std::unique_ptr<ConfigNode> base = load(*base_text, included, longer);
  merge(*base->table(), *root->table());
  base->origin = root->origin;
  return base;
}

// ---- overrides

[[noreturn]] void fail_set(const std::string& key, const std::string& message) {
  throw ConfigError(fmt::format("--set {}: {}", key, message));
}

std::string trimmed(const std::string& text) {
  constexpr const char* blanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::vector<std::string> split_key(const std::string& key) {
  std::vector<std::string> parts;
  std::istringstream stream(key + ".");
  for (std::string part; std::getline(stream, part, '.');) {
    if (part.empty() || key_text(part) != part) {
      fail_set(key, "a key is letters, digits, '_' and '-', parted by dots: write a.b.c=value");
    }
    parts.push_back(part);
  }
  return parts;
}

std::unique_ptr<ConfigNode> parse_value(const std::string& key, const std::string& text) {
  if (text.empty()) fail_set(key, "a value is missing after '='; an empty string is \"\"");
  const ConfigOrigin origin{"", 0, key};
  std::string problem = "more than one value";
  try {
    const toml::table parsed = toml::parse("value = " + text);
    if (parsed.size() == 1) return converted(*parsed.get("value"), origin);
  } catch (const toml::parse_error& error) {
    if (text.find_first_of(" \t\r\n\"'[]{},#=") == std::string::npos) {
      auto word = std::make_unique<ConfigNode>();
      word->value = text;
      word->origin = origin;
      return word;
    }
    problem = error.description();
  }
  fail_set(key, fmt::format("'{}' is not a TOML value: {}; a text with blanks or brackets needs "
                            "quotes inside the shell's",
                            text, problem));
}

std::unique_ptr<ConfigNode>& element_at(ConfigArray& array, const std::string& part,
                                        const std::string& key) {
  const std::size_t size = array.elements.size();
  std::size_t index = 0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
  if (error == std::errc{} && end == part.data() + part.size() && index < size) {
    return array.elements[index];
  }
  const std::string range = size == 0 ? "it is empty" : fmt::format("0 to {} exist", size - 1);
  fail_set(key, fmt::format("'{}' is not the index of an element of that array: {}", part, range));
}

/// The place that `parts` name, missing tables on the way made; holds nothing when it is new.
std::unique_ptr<ConfigNode>& place_of(ConfigNode& root, const std::vector<std::string>& parts,
                                      const std::string& key) {
  ConfigNode* node = &root;
  std::unique_ptr<ConfigNode>* place = nullptr;
  std::string walked;
  for (const std::string& part : parts) {
    if (place && !*place) {
      *place = std::make_unique<ConfigNode>();
      (*place)->value = ConfigTable{};
      (*place)->origin.set_key = key;
    }
    if (place) node = place->get();
    if (ConfigArray* array = node->array()) {
      place = &element_at(*array, part, key);
    } else if (ConfigTable* table = node->table()) {
      auto member = std::find_if(table->members.begin(), table->members.end(),
                                 [&](const auto& m) { return m.first == part; });
      if (member == table->members.end()) {
        member = table->members.emplace(table->members.end(), part, nullptr);
      }
      place = &member->second;
    } else {
      fail_set(key, fmt::format("'{}' is {} and has no '{}' in it", walked, describe(*node), part));
    }
    walked = member_path(walked, part);
  }
  return *place;
}

void apply_override(ConfigNode& root, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) {
    fail_set(assignment, "no '=' in it: write --set key=value");
  }
  const std::string key = trimmed(assignment.substr(0, equals));
  if (key.empty()) fail_set(assignment, "no key before '=': write --set key=value");
  const std::vector<std::string> parts = split_key(key);
  if (parts.front() == "include") fail_set(key, "a file is included only from within a case file");
  std::unique_ptr<ConfigNode> value = parse_value(key, trimmed(assignment.substr(equals + 1)));
  place_of(root, parts, key) = std::move(value);
}

}  // namespace

std::optional<std::string> file_text(const fs::path& file, std::string& reason) {
  std::error_code ignored;
  errno = fs::is_directory(file, ignored) ? EISDIR : 0;
  if (errno == 0) {
    std::ifstream stream(file, std::ios::binary);
    if (stream) {
      std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
      if (!stream.bad()) return text;
    }
  }
  reason = errno != 0 ? std::strerror(errno) : "reading failed";
  return std::nullopt;
}

std::unique_ptr<ConfigTree> parse_config(const std::string& text, const std::string& name,
                                         const std::vector<std::string>& overrides) {
  auto tree = std::make_unique<ConfigTree>();
  tree->name = name;
  tree->directory = directory_of(name);
  tree->root = std::move(*load(text, name, {identity(name)}));
  for (const std::string& assignment : overrides) apply_override(tree->root, assignment);
  set_paths(tree->root);
  return tree;
}

std::unique_ptr<ConfigTree> read_config(const fs::path& given,
                                        const std::vector<std::string>& overrides) {
  const fs::path file = case_file(given);
  std::string reason;
  const std::optional<std::string> text = file_text(file, reason);
  if (!text) {
    throw ConfigError(fmt::format(
        "{}: cannot be read: {}; give a case directory (holding case.toml) or a .toml file",
        file.string(), reason));
  }
  return parse_config(*text, file.string(), overrides);
}

}  // namespace odpd
