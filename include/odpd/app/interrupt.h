#pragma once
// Ctrl-C and kill: the first asks the run to end after the step at hand, the second ends the process at once.
namespace odpd {

/// Installs the handlers for SIGINT and SIGTERM, and lets writes beyond a file-size limit fail instead of kill.
void catch_signals();
/// True once a signal has come.
bool interrupted();

}  // namespace odpd
