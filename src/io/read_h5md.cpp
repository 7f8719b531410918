// read_h5md of trajectory.h: the last frame of an H5MD file, whoever wrote it.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/io/trajectory.h"

namespace odpd {

namespace {

/// An H5MD element: a fixed dataset, or a group with step, time and value.
class Element {
 public:
  Element(const H5Reader& reader, std::string path)
      : reader_(reader),
        path_(std::move(path)),
        varies_(reader.has(path_ + "/value")),
        value_(varies_ ? path_ + "/value" : path_) {}

  bool exists() const { return reader_.has(value_); }
  /// Shape of one frame.
  std::vector<std::int64_t> shape() const {
    auto shape = reader_.shape(value_);
    if (varies_ && !shape.empty()) shape.erase(shape.begin());
    return shape;
  }
  /// Number of the last frame; -1: there is none.
  std::int64_t last() const {
    if (!varies_) return 0;
    const auto shape = reader_.shape(value_);
    return shape.empty() ? -1 : shape.front() - 1;
  }
  std::vector<std::int64_t> integers() const {
    return varies_ ? reader_.read_integers(value_, last()) : reader_.read_integers(value_);
  }
  std::vector<double> doubles() const {
    if (reader_.is_integer(value_)) {
      const auto values = integers();
      return {values.begin(), values.end()};
    }
    return varies_ ? reader_.read_doubles(value_, last()) : reader_.read_doubles(value_);
  }
  /// Step or time of the last frame: listed frame by frame, or an increment with an offset.
  double label(const std::string& name) const {
    const Element labels(reader_, path_ + "/" + name);
    if (!varies_ || !labels.exists()) return 0.0;
    const auto values = labels.doubles();
    if (!labels.shape().empty()) return values.empty() ? 0.0 : values.back();
    return reader_.number_attribute(path_ + "/" + name, "offset", 0.0) +
           static_cast<double>(last()) * values.front();
  }

 private:
  const H5Reader& reader_;
  std::string path_;
  bool varies_;
  std::string value_;
};

/// Reads one group of particles.
class FrameReader {
 public:
  FrameReader(const H5Reader& reader, std::string file, std::string group)
      : reader_(reader), file_(std::move(file)), group_(std::move(group)) {}

  Frame read() const {
    Frame frame;
    const Element position = element("position");
    const auto shape = position.shape();
    if (position.last() < 0) fail("position", "has no frame");
    if (shape.size() != 2 || (shape[1] != 2 && shape[1] != 3)) {
      fail("position", "is not of shape [particles][2 or 3]");
    }
    frame.dimension = static_cast<int>(shape[1]);
    frame.step = std::llround(position.label("step"));
    frame.time = position.label("time");
    frame.position = position.doubles();
    const auto count = index(shape[0]);
    const std::size_t flat = frame.position.size();
    frame.velocity = optional_doubles("velocity", flat);
    frame.image = optional_integers("image", flat);
    frame.species = optional_integers("species", count);
    frame.group = optional_integers("group", count);
    frame.id = optional_integers("id", count);
    if (frame.id.size() < count) {
      frame.id.resize(count);
      std::iota(frame.id.begin(), frame.id.end(), 0);
    }
    frame.species_names = reader_.text_attribute("/parameters/odpd", "species_names");
    read_box(frame);
    return frame;
  }

 private:
  Element element(const std::string& name) const { return {reader_, group_ + "/" + name}; }

  [[noreturn]] void fail(const std::string& name, const std::string& what) const {
    throw IoError(
        fmt::format("{}: '{}/{}' {}; give an H5MD file of one box and one set of "
                    "particles",
                    file_, group_, name, what));
  }

  template <class T>
  std::vector<T> sized(const std::string& name, std::vector<T> values, std::size_t size) const {
    if (values.size() == size) return values;
    fail(name, fmt::format("has {} values where {} are expected", values.size(), size));
  }
  std::vector<double> optional_doubles(const std::string& name, std::size_t size) const {
    if (!element(name).exists()) return {};
    return sized(name, element(name).doubles(), size);
  }
  std::vector<std::int64_t> optional_integers(const std::string& name, std::size_t size) const {
    if (!element(name).exists()) return {};
    return sized(name, element(name).integers(), size);
  }

  void read_box(Frame& frame) const {
    const Element edges = element("box/edges");
    if (!edges.exists() || edges.last() < 0) return;
    const auto dimension = index(frame.dimension);
    const auto values = edges.doubles();
    if (values.size() == dimension) {
      frame.box_size = values;
    } else {
      // Edge vectors, one per row.
      sized("box/edges", values, dimension * dimension);
      bool tilted = false;
      for (std::size_t i = 0; i < values.size(); ++i) {
        const bool diagonal = i % (dimension + 1) == 0;
        if (diagonal) frame.box_size.push_back(values[i]);
        tilted = tilted || (!diagonal && values[i] != 0.0);
      }
      if (tilted) frame.edges = values;
    }
    const auto boundary = reader_.text_attribute(group_ + "/box", "boundary");
    for (std::size_t c = 0; c < dimension; ++c) {
      frame.periodic.push_back(c < boundary.size() && boundary[c] == "periodic");
    }
  }

  const H5Reader& reader_;
  std::string file_, group_;
};

template <class T>
void reorder(std::vector<T>& values, const std::vector<std::size_t>& order, std::size_t width) {
  if (values.empty()) return;  // an array the file does not have
  std::vector<T> sorted;
  sorted.reserve(order.size() * width);
  for (const std::size_t from : order) {
    for (std::size_t c = 0; c < width; ++c) sorted.push_back(values[from * width + c]);
  }
  values = std::move(sorted);
}

/// Ascending ids; a negative one marks an unused place in files with a varying number of particles.
void sort_by_id(Frame& frame) {
  std::vector<std::size_t> order;
  for (std::size_t p = 0; p < frame.id.size(); ++p) {
    if (frame.id[p] >= 0) order.push_back(p);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return frame.id[a] < frame.id[b]; });
  const auto dimension = index(frame.dimension);
  reorder(frame.id, order, 1);
  reorder(frame.species, order, 1);
  reorder(frame.group, order, 1);
  reorder(frame.position, order, dimension);
  reorder(frame.image, order, dimension);
  reorder(frame.velocity, order, dimension);
}

}  // namespace

Frame read_h5md(const std::filesystem::path& file) {
  const H5Reader reader(file);
  std::vector<std::string> names = reader.children("/particles");
  // Our own name for everything comes first.
  std::stable_partition(names.begin(), names.end(),
                        [](const std::string& name) { return name == "all"; });
  for (const std::string& name : names) {
    const std::string group = "/particles/" + name;
    if (!Element(reader, group + "/position").exists()) continue;
    Frame frame = FrameReader(reader, file.string(), group).read();
    sort_by_id(frame);
    return frame;
  }
  throw IoError(
      fmt::format("{}: has no positions under /particles; give an H5MD file", file.string()));
}

}  // namespace odpd
