#pragma once
// A checkpoint in memory, for round trips without a file; `doubles` and `integers` are open so that
// tests can damage them.
#include <map>
#include <string>
#include <vector>

#include "odpd/core/archive.h"
#include "odpd/core/error.h"

namespace support {

class MemoryArchive : public odpd::StateWriter, public odpd::StateReader {
 public:
  std::map<std::string, std::vector<double>> doubles;
  std::map<std::string, std::vector<std::int64_t>> integers;
  std::map<std::string, std::string> texts;

  void write(const std::string& name, const std::vector<double>& values) override {
    insert(doubles, name, values);
  }
  void write(const std::string& name, const std::vector<std::int64_t>& values) override {
    insert(integers, name, values);
  }
  void write_text(const std::string& name, const std::string& text) override {
    insert(texts, name, text);
  }

  bool has(const std::string& name) const override {
    return doubles.count(name) + integers.count(name) + texts.count(name) > 0;
  }
  std::vector<double> read_doubles(const std::string& name) const override {
    return find(doubles, name);
  }
  std::vector<std::int64_t> read_integers(const std::string& name) const override {
    return find(integers, name);
  }
  std::string read_text(const std::string& name) const override { return find(texts, name); }

 private:
  template <class T>
  void insert(std::map<std::string, T>& values, const std::string& name, const T& value) {
    if (has(name)) throw odpd::IoError("'" + name + "' was written twice");
    values[name] = value;
  }
  template <class T>
  static T find(const std::map<std::string, T>& values, const std::string& name) {
    const auto at = values.find(name);
    if (at == values.end()) throw odpd::IoError("'" + name + "' is missing or of another type");
    return at->second;
  }
};

}  // namespace support
