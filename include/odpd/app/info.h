#pragma once
// `odpd info`: version, build options, instruction path, backends and machine.
#include <string>

namespace odpd {

std::string info_text();

}  // namespace odpd
