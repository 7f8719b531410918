#pragma once
// How components with memory save and load themselves: named flat arrays.
// The file behind it (HDF5) lives in io; components only see these two interfaces.
#include <cstdint>
#include <string>
#include <vector>

namespace odpd {

/// Receives a component's state under names unique within the component ("pair_list/reference").
class StateWriter {
 public:
  virtual ~StateWriter() = default;
  virtual void write(const std::string& name, const std::vector<double>& values) = 0;
  virtual void write(const std::string& name, const std::vector<std::int64_t>& values) = 0;
  virtual void write_text(const std::string& name, const std::string& text) = 0;
};

/// Gives it back bit for bit. Throws IoError for a missing name or another type.
class StateReader {
 public:
  virtual ~StateReader() = default;
  virtual bool has(const std::string& name) const = 0;
  virtual std::vector<double> read_doubles(const std::string& name) const = 0;
  virtual std::vector<std::int64_t> read_integers(const std::string& name) const = 0;
  virtual std::string read_text(const std::string& name) const = 0;
};

}  // namespace odpd
