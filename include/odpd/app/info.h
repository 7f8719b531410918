#pragma once
// `odpd info`: version, build options, instruction path, backends and machine.
#include <string>

namespace odpd {

std::string info_text();
/// Processor, number of processors, memory.
std::string machine_text();

}  // namespace odpd
