#pragma once
// A small ordered JSON value for summaries, so that nlohmann/json stays inside .cpp files.
#include <cstdint>
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

}  // namespace odpd
