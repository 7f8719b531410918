#pragma once
// What the tests of Config share.
#include <gtest/gtest.h>

#include <string>

#include "odpd/core/config.h"
#include "odpd/core/error.h"

namespace config_test {

template <class Call>
std::string error_of(const Call& call) {
  try {
    call();
  } catch (const odpd::ConfigError& error) {
    return error.what();
  }
  return "no error";
}

inline void expect_contains(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << "'" << part << "' is not in: " << text;
}

inline const std::string sample = R"(title = "a channel"
dimension = 2

[box]
size = [10.0, 12]
periodic = [true, false]

[fluid]
a = 18.5
n = 4

[[wall]]
shape = "plane"
velocity = [1.0, 0.0]

[[wall]]
shape = "disc"
motion = { rate = 0.5 }
)";

}  // namespace config_test
