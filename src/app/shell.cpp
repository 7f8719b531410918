#include "odpd/app/shell.h"

#include <algorithm>

#include "odpd/core/config.h"

namespace odpd {

std::string shell_quoted(const std::string& word) {
  const auto plain = [](char c) {
    return is_plain_name(std::string(1, c)) || std::string("./=+,:").find(c) != std::string::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), plain)) return word;
  std::string out = "'";
  for (const char c : word) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

}  // namespace odpd
