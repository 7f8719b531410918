#pragma once
// Expects an error of one type whose message names what it must name.
#include <gtest/gtest.h>

#include <exception>
#include <initializer_list>
#include <string>

#include "odpd/core/error.h"

namespace support {

template <class E, class Action>
void expect_error(const Action& action, std::initializer_list<const char*> parts) {
  try {
    action();
  } catch (const E& error) {
    for (const char* part : parts) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos)
          << "'" << part << "' is missing in: " << error.what();
    }
    return;
  } catch (const std::exception& error) {
    ADD_FAILURE() << "an error of another type: " << error.what();
    return;
  }
  ADD_FAILURE() << "no error was thrown";
}

}  // namespace support
