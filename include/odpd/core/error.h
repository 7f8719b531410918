#pragma once
// Errors the library throws. Each message names what was wrong, where, and the remedy;
// only the program's main turns one into text on stderr and an exit code.
#include <cstdint>
#include <stdexcept>
#include <string>

namespace odpd {

/// Root of every error odpd throws. `exit_code` is what the program returns for it.
class Error : public std::runtime_error {
 public:
  Error(const std::string& message, int exit_code)
      : std::runtime_error(message), exit_code_(exit_code) {}
  int exit_code() const { return exit_code_; }

 private:
  int exit_code_;
};

/// A case file, option or argument is wrong (exit code 1).
class ConfigError : public Error {
 public:
  explicit ConfigError(const std::string& message) : Error(message, 1) {}
};

/// A linear solve failed or the physics left its range: not converged, singular, NaN (exit code 2).
class SolverError : public Error {
 public:
  enum class Cause { other, not_converged, singular, blow_up };
  explicit SolverError(const std::string& message, Cause cause = Cause::other)
      : Error(message, 2), cause_(cause) {}
  Cause cause() const { return cause_; }

 private:
  Cause cause_;
};

/// The particles' state has left the physics: one moves beyond half the box, a number is not finite, all are too hot.
class BlowUpError : public SolverError {
 public:
  /// particle: identity of the one that shows it, -1 for none.
  explicit BlowUpError(const std::string& message, std::int64_t particle = -1)
      : SolverError(message, Cause::blow_up), particle_(particle) {}
  std::int64_t particle() const { return particle_; }

 private:
  std::int64_t particle_;
};

/// A bond as long as half the box, where another image of its end may be nearer than the bonded one.
class BondTooLongError : public BlowUpError {
 public:
  using BlowUpError::BlowUpError;
};

/// A file could not be read or written (exit code 3).
class IoError : public Error {
 public:
  explicit IoError(const std::string& message) : Error(message, 3) {}
};

}  // namespace odpd
