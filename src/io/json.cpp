#include "odpd/io/json.h"

#include <cmath>
#include <nlohmann/json.hpp>

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

}  // namespace odpd
