#pragma once
// Small ordered JSON objects to write, and documents to look things up in, so that nlohmann/json
// stays inside .cpp files.
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace odpd {

/// An ordered JSON object under construction. Numbers are written with all their digits; NaN and
/// infinity as null.
class JsonObject {
 public:
  JsonObject();
  ~JsonObject();
  JsonObject(const JsonObject&);
  JsonObject& operator=(const JsonObject&);
  JsonObject& set(const std::string& key, double value);
  JsonObject& set(const std::string& key, std::int64_t value);
  JsonObject& set(const std::string& key, std::uint64_t value);
  JsonObject& set(const std::string& key, int value) {
    return set(key, static_cast<std::int64_t>(value));
  }
  JsonObject& set(const std::string& key, bool value);
  JsonObject& set(const std::string& key, const std::string& value);
  JsonObject& set(const std::string& key, const char* value) {
    return set(key, std::string(value));
  }
  JsonObject& set(const std::string& key, const JsonObject& value);
  JsonObject& set(const std::string& key, const std::vector<JsonObject>& values);
  JsonObject& set(const std::string& key, const std::vector<double>& values);
  std::string text() const;  ///< indented by 2

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A JSON file to look things up in by path: {"observables", "pressure", "mean"}; elements of an array by their index
/// from 0: {"measurements", "1", "eta"}.
class JsonDocument {
 public:
  /// Throws IoError naming the file when it cannot be read or is no JSON.
  explicit JsonDocument(const std::filesystem::path& file);
  /// The same of the text of a file; `name` stands for it in messages.
  JsonDocument(const std::string& text, const std::string& name);
  ~JsonDocument();
  JsonDocument(JsonDocument&&) noexcept;
  using Path = std::vector<std::string>;
  double number(const Path& path) const;                  ///< NaN when absent or not a number
  std::string text(const Path& path) const;               ///< "" when absent or not a string
  std::size_t count(const Path& path) const;              ///< elements of the array there
  std::vector<std::string> keys(const Path& path) const;  ///< of the object there, in their order

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace odpd
