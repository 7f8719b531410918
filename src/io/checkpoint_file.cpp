#include "odpd/io/checkpoint_file.h"

#include <fmt/format.h>

#include "odpd/core/error.h"

namespace odpd {

namespace {

// The number goes up when a checkpoint can no longer be read by older programs.
constexpr const char* format_path = "/odpd_checkpoint_format";
constexpr std::int64_t format_number = 4;

std::string group_of(const std::string& component) { return "/components/" + component; }

}  // namespace

struct CheckpointWriter::Component : StateWriter {
  Component(H5Image& image, const std::string& name) : image_(image), group_(group_of(name)) {
    image_.group(group_);
  }
  void write(const std::string& name, const std::vector<double>& values) override {
    image_.write(group_ + "/" + name, values, {static_cast<std::int64_t>(values.size())});
  }
  void write(const std::string& name, const std::vector<std::int64_t>& values) override {
    image_.write(group_ + "/" + name, values, {static_cast<std::int64_t>(values.size())});
  }
  void write_text(const std::string& name, const std::string& text) override {
    image_.write_text(group_ + "/" + name, text);
  }

 private:
  H5Image& image_;
  std::string group_;
};

CheckpointWriter::CheckpointWriter() {
  image_.write(format_path, std::vector<std::int64_t>{format_number}, {});
}

StateWriter& CheckpointWriter::component(const std::string& name) {
  return *components_.emplace_back(std::make_unique<Component>(image_, name));
}

void CheckpointWriter::save(const std::filesystem::path& file) const { image_.save(file); }

struct CheckpointReader::Component : StateReader {
  Component(const H5Reader& reader, std::string file, std::string name)
      : reader_(reader), file_(std::move(file)), component_(std::move(name)) {}
  bool has(const std::string& name) const override { return reader_.has(path(name)); }
  std::vector<double> read_doubles(const std::string& name) const override {
    return reader_.read_doubles(found(name));
  }
  std::vector<std::int64_t> read_integers(const std::string& name) const override {
    return reader_.read_integers(found(name));
  }
  std::string read_text(const std::string& name) const override {
    return reader_.read_text(found(name));
  }

 private:
  std::string path(const std::string& name) const { return group_of(component_) + "/" + name; }
  std::string found(const std::string& name) const {
    if (has(name)) return path(name);
    throw IoError(
        fmt::format("{}: holds no '{}' of '{}': the case or the program changed since; "
                    "start the run afresh",
                    file_, name, component_));
  }
  const H5Reader& reader_;
  std::string file_, component_;
};

CheckpointReader::CheckpointReader(const std::filesystem::path& file)
    : reader_(file), file_(file.string()) {
  if (!reader_.has(format_path)) {
    throw IoError(fmt::format("{}: is no odpd checkpoint; name a checkpoint.h5", file_));
  }
  const auto found = reader_.read_integers(format_path);
  if (found.size() == 1 && found.front() == format_number) return;
  throw IoError(
      fmt::format("{}: is a checkpoint of format {}, this program reads format {}; "
                  "use the program that wrote it",
                  file_, fmt::join(found, ","), format_number));
}

bool CheckpointReader::has(const std::string& name) const { return reader_.has(group_of(name)); }

StateReader& CheckpointReader::component(const std::string& name) {
  if (!has(name)) {
    throw IoError(
        fmt::format("{}: holds no state of '{}': the case or the program changed since; "
                    "start the run afresh",
                    file_, name));
  }
  return *components_.emplace_back(std::make_unique<Component>(reader_, file_, name));
}

}  // namespace odpd
