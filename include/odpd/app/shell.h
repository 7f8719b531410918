#pragma once
// Words of a command line as a shell reads them, for the commands that odpd tells its user.
#include <string>

namespace odpd {

/// The word itself where it is plain, else in single quotes.
std::string shell_quoted(const std::string& word);

}  // namespace odpd
