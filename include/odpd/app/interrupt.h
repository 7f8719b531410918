#pragma once
// Ctrl-C and kill: the first asks the run to end after the step at hand, the second ends the process at once.
namespace odpd {

/// Installs the handlers for SIGINT and SIGTERM: call where something asks `interrupted()`.
void catch_signals();
/// A write beyond a file-size limit then fails, with a message, instead of killing the program.
void let_large_writes_fail();
/// True once a signal has come.
bool interrupted();

}  // namespace odpd
