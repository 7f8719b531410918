#pragma once
// Messages for the user on stderr; results go to stdout and files, never through here.
#include <string>

namespace odpd {

void log_info(const std::string& message);
void log_warning(const std::string& message);
/// Only warnings and errors from now on.
void set_quiet(bool quiet);

}  // namespace odpd
