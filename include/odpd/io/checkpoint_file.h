#pragma once
// checkpoint.h5: what every component with memory saved, each under its own name, in one whole
// file.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "odpd/core/archive.h"
#include "odpd/io/h5_file.h"

namespace odpd {

class CheckpointWriter {
 public:
  CheckpointWriter();
  CheckpointWriter(const CheckpointWriter&) = delete;  // components refer to it
  CheckpointWriter& operator=(const CheckpointWriter&) = delete;
  /// The place of one component ("particles", "observer_0"); valid while this object lives.
  StateWriter& component(const std::string& name);
  void save(const std::filesystem::path& file) const;

 private:
  struct Component;
  H5Image image_;
  std::vector<std::unique_ptr<StateWriter>> components_;
};

class CheckpointReader {
 public:
  /// Throws IoError "FILE: ..." when it is no readable odpd checkpoint.
  explicit CheckpointReader(const std::filesystem::path& file);
  CheckpointReader(const CheckpointReader&) = delete;  // components refer to it
  CheckpointReader& operator=(const CheckpointReader&) = delete;
  bool has(const std::string& name) const;
  /// What one component saved. Throws IoError when the checkpoint has no such component.
  StateReader& component(const std::string& name);

 private:
  struct Component;
  H5Reader reader_;
  std::string file_;
  std::vector<std::unique_ptr<StateReader>> components_;
};

}  // namespace odpd
