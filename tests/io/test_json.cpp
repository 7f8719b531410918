#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "io/temporary_directory.h"
#include "odpd/core/error.h"
#include "odpd/io/file.h"
#include "odpd/io/json.h"

namespace odpd {
namespace {

TEST(Json, KeepsOrderAndIndents) {
  JsonObject inner;
  inner.set("b", true).set("a", "text \"quoted\"");
  JsonObject object;
  object.set("z", 1).set("list", std::vector<double>{1.0, 2.5}).set("inner", inner);
  object.set("many", std::vector<JsonObject>{inner, JsonObject()});
  EXPECT_EQ(object.text(),
            "{\n  \"z\": 1,\n  \"list\": [\n    1.0,\n    2.5\n  ],\n  \"inner\": {\n"
            "    \"b\": true,\n    \"a\": \"text \\\"quoted\\\"\"\n  },\n  \"many\": [\n    {\n"
            "      \"b\": true,\n      \"a\": \"text \\\"quoted\\\"\"\n    },\n    {}\n  ]\n}");
}

TEST(Json, DoublesReadBackAndNonFiniteOnesAreNull) {
  using limits = std::numeric_limits<double>;
  const std::vector<double> values{0.1, 1.0 / 3.0, limits::denorm_min(), limits::max(), -1e-7};
  JsonObject object;
  object.set("values", values)
      .set("nan", limits::quiet_NaN())
      .set("infinite", std::vector<double>{limits::infinity(), 1.0})
      .set("large", std::numeric_limits<std::int64_t>::max())
      .set("size", values.size());
  const auto read = nlohmann::json::parse(object.text());
  EXPECT_EQ(read["values"].get<std::vector<double>>(), values);
  EXPECT_TRUE(read["nan"].is_null());
  EXPECT_TRUE(read["infinite"][0].is_null());
  EXPECT_EQ(read["infinite"][1], 1.0);
  EXPECT_EQ(read["large"].get<std::int64_t>(), std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(read["size"], 5);
}

TEST(Json, CopiesAreIndependentAndAKeyIsReplacedInPlace) {
  JsonObject first;
  first.set("a", 1).set("b", 2);
  JsonObject second = first;
  second.set("a", 3);
  EXPECT_EQ(nlohmann::json::parse(first.text())["a"], 1);
  EXPECT_LT(second.text().find("\"a\": 3"), second.text().find("\"b\""));
  second.set("self", second);
  EXPECT_EQ(nlohmann::json::parse(second.text())["self"]["b"], 2);
}

TEST(Json, BytesThatAreNoUtf8DoNotThrow) {
  JsonObject object;
  object.set("path", std::string("bad \xFF byte"));
  EXPECT_NO_THROW(nlohmann::json::parse(object.text()));
}

TEST(JsonDocument, FindsByPathAndSaysNothingIsThere) {
  const test::TemporaryDirectory directory;
  write_file_atomically(directory / "a.json",
                        R"({"a": {"b": 1.5, "c": null, "d": "x"}, "e": true, "f": 2})");
  const JsonDocument json(directory / "a.json");
  EXPECT_EQ(json.number({"a", "b"}), 1.5);
  EXPECT_EQ(json.number({"f"}), 2.0);
  EXPECT_TRUE(std::isnan(json.number({"a", "c"})));
  EXPECT_TRUE(std::isnan(json.number({"a", "b", "c"})));
  EXPECT_EQ(json.text({"a", "d"}), "x");
  EXPECT_EQ(json.text({"e"}), "");
  EXPECT_EQ(json.keys({"a"}), (std::vector<std::string>{"b", "c", "d"}));
  EXPECT_TRUE(json.keys({"z"}).empty());
  write_file_atomically(directory / "half.json", "{\"a\": ");
  EXPECT_NE(
      test::message_of<IoError>([&] { JsonDocument(directory / "half.json"); }).find("half.json"),
      std::string::npos);
}

}  // namespace
}  // namespace odpd
