#pragma once
// `odpd info`: version, build options, instruction path, backends and machine.
#include <string>

namespace odpd {

std::string info_text();
/// Processor, number of processors, memory.
std::string machine_text();

/// What tells this program from one of other sources or other compiler switches: a hash of the files it was loaded from.
const std::string& build_identity();

}  // namespace odpd
