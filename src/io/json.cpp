#include "odpd/io/json.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "odpd/core/error.h"
#include "odpd/io/file.h"

namespace odpd {

namespace {

using Value = nlohmann::ordered_json;

/// JSON has no word for NaN and infinity.
Value number(double value) { return std::isfinite(value) ? Value(value) : Value(nullptr); }

}  // namespace

struct JsonObject::Impl {
  Value value = Value::object();
};

JsonObject::JsonObject() : impl_(std::make_unique<Impl>()) {}
JsonObject::~JsonObject() = default;
JsonObject::JsonObject(const JsonObject& other) : impl_(std::make_unique<Impl>(*other.impl_)) {}
JsonObject& JsonObject::operator=(const JsonObject& other) {
  *impl_ = Impl(*other.impl_);
  return *this;
}

JsonObject& JsonObject::set(const std::string& key, double value) {
  impl_->value[key] = number(value);
  return *this;
}

JsonObject& JsonObject::set(const std::string& key, std::int64_t value) {
  impl_->value[key] = value;
  return *this;
}

JsonObject& JsonObject::set(const std::string& key, std::uint64_t value) {
  impl_->value[key] = value;
  return *this;
}

JsonObject& JsonObject::set(const std::string& key, bool value) {
  impl_->value[key] = value;
  return *this;
}

JsonObject& JsonObject::set(const std::string& key, const std::string& value) {
  impl_->value[key] = value;
  return *this;
}

JsonObject& JsonObject::set(const std::string& key, const JsonObject& value) {
  Value copy = value.impl_->value;  // `value` may be this object
  impl_->value[key] = std::move(copy);
  return *this;
}

JsonObject& JsonObject::set(const std::string& key, const std::vector<JsonObject>& values) {
  Value array = Value::array();
  for (const JsonObject& value : values) array.push_back(value.impl_->value);
  impl_->value[key] = std::move(array);
  return *this;
}

JsonObject& JsonObject::set(const std::string& key, const std::vector<double>& values) {
  Value array = Value::array();
  for (const double value : values) array.push_back(number(value));
  impl_->value[key] = std::move(array);
  return *this;
}

std::string JsonObject::text() const {
  // Bytes that are no UTF-8 (a path may hold them) are replaced rather than refused.
  return impl_->value.dump(2, ' ', false, Value::error_handler_t::replace);
}

struct JsonDocument::Impl {
  Value value;
  /// The value at `path`, null when there is none.
  const Value* find(const Path& path) const {
    const Value* here = &value;
    for (const std::string& key : path) {
      if (here->is_array()) {
        std::size_t index = 0;
        const auto [end, status] = std::from_chars(key.data(), key.data() + key.size(), index);
        if (status != std::errc{} || end != key.data() + key.size() || index >= here->size())
          return nullptr;
        here = &here->at(index);
        continue;
      }
      if (!here->is_object() || !here->contains(key)) return nullptr;
      here = &here->at(key);
    }
    return here;
  }
};

JsonDocument::JsonDocument(const std::filesystem::path& file)
    : JsonDocument(read_file(file), file.string()) {}
JsonDocument::JsonDocument(const std::string& text, const std::string& name)
    : impl_(std::make_unique<Impl>()) {
  impl_->value = Value::parse(text, nullptr, false);
  if (impl_->value.is_discarded())
    throw IoError(fmt::format("{}: is not JSON; remove it, so that it is written again", name));
}
JsonDocument::~JsonDocument() = default;
JsonDocument::JsonDocument(JsonDocument&&) noexcept = default;

double JsonDocument::number(const Path& path) const {
  const Value* found = impl_->find(path);
  return found && found->is_number() ? found->get<double>()
                                     : std::numeric_limits<double>::quiet_NaN();
}

std::string JsonDocument::text(const Path& path) const {
  const Value* found = impl_->find(path);
  return found && found->is_string() ? found->get<std::string>() : "";
}

std::size_t JsonDocument::count(const Path& path) const {
  const Value* found = impl_->find(path);
  return found && found->is_array() ? found->size() : 0;
}

std::vector<std::string> JsonDocument::keys(const Path& path) const {
  std::vector<std::string> names;
  const Value* found = impl_->find(path);
  if (found && found->is_object())
    for (const auto& member : found->items()) names.push_back(member.key());
  return names;
}

}  // namespace odpd
