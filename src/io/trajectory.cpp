#include "odpd/io/trajectory.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdlib>
#include <optional>
#include <string_view>

#include "odpd/core/error.h"
#include "odpd/core/index.h"
#include "odpd/io/file.h"

namespace odpd {

namespace {

namespace fs = std::filesystem;

constexpr const char* all = "/particles/all";
constexpr std::string_view prefix = "trajectory.";
constexpr std::string_view suffix = ".h5";

std::string segment_name(std::int64_t number) {
  return fmt::format("{}{:04}{}", prefix, number, suffix);
}

/// The number in the name of a segment; none for other files.
std::optional<std::int64_t> segment_number(std::string_view name) {
  if (!name.starts_with(prefix) || !name.ends_with(suffix)) return {};
  if (name.size() <= prefix.size() + suffix.size()) return {};
  const char* first = name.data() + prefix.size();
  const char* last = name.data() + name.size() - suffix.size();
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(first, last, number);
  if (error != std::errc() || end != last || number < 0) return {};
  return number;
}

std::string author() {
  const char* name = std::getenv("USER");
  return name == nullptr || *name == '\0' ? "unknown" : name;
}

/// One after the other. A rectangular box has a matrix as well: H5MD allows a vector, which not every reader takes.
std::vector<double> edge_vectors(const Frame& frame) {
  if (!frame.edges.empty()) return frame.edges;
  const auto dimension = index(frame.dimension);
  std::vector<double> edges(dimension * dimension, 0.0);
  for (std::size_t c = 0; c < dimension; ++c) edges[c * (dimension + 1)] = frame.box_size[c];
  return edges;
}

/// A time-dependent element: its own values, and the step and time shared with the position.
void create_element(H5Image& image, const std::string& path,
                    const std::vector<std::int64_t>& row_shape, bool integers) {
  image.create_rows(path + "/value", row_shape, integers);
  const std::string owner = std::string(all) + "/position";
  if (path == owner) {
    image.create_rows(path + "/step", {}, true);
    image.create_rows(path + "/time", {}, false);
  } else {
    image.hard_link(owner + "/step", path + "/step");
    image.hard_link(owner + "/time", path + "/time");
  }
}

}  // namespace

TrajectorySegments::TrajectorySegments(fs::path directory, std::string case_text,
                                       std::string version, std::string title)
    : directory_(std::move(directory)),
      case_text_(std::move(case_text)),
      version_(std::move(version)),
      title_(std::move(title)) {}

void TrajectorySegments::open(const Frame& frame) {
  image_ = std::make_unique<H5Image>();
  image_->group("/h5md/author");
  image_->attribute("/h5md", "version", std::vector<std::int64_t>{1, 1});
  image_->attribute("/h5md/author", "name", author());
  image_->group("/h5md/creator");
  image_->attribute("/h5md/creator", "name", std::string("odpd"));
  image_->attribute("/h5md/creator", "version", version_);

  image_->write_text("/parameters/odpd/case", case_text_);
  image_->write_text("/parameters/odpd/version", version_);
  image_->write_text("/parameters/odpd/title", title_);
  image_->attribute("/parameters/odpd", "species_names", frame.species_names);

  const auto count = static_cast<std::int64_t>(frame.id.size());
  const std::vector<std::int64_t> vectors{count, frame.dimension};
  const std::string group = all;
  create_element(*image_, group + "/position", vectors, false);
  create_element(*image_, group + "/image", vectors, true);
  create_element(*image_, group + "/velocity", vectors, false);
  if (!frame.spin.empty())
    create_element(*image_, group + "/angular_velocity",
                   frame.dimension == 2 ? std::vector<std::int64_t>{count} : vectors, false);
  if (!frame.density.empty()) create_element(*image_, group + "/density", {count}, false);
  image_->write(group + "/id", frame.id, {count});
  image_->write(group + "/species", frame.species, {count});
  image_->write(group + "/group", frame.group, {count});
  open_box(frame);
  if (frame.bonds.empty()) return;
  image_->write("/connectivity/bonds", frame.bonds,
                {static_cast<std::int64_t>(frame.bonds.size() / 2), 2});
  image_->reference("/connectivity/bonds", "particles_group", all);
}

void TrajectorySegments::open_box(const Frame& frame) {
  const std::string box = std::string(all) + "/box";
  std::vector<std::string> boundary;
  for (const bool periodic : frame.periodic) boundary.push_back(periodic ? "periodic" : "none");
  image_->group(box);
  image_->attribute(box, "dimension", std::int64_t{frame.dimension});
  image_->attribute(box, "boundary", boundary);
  create_element(*image_, box + "/edges", {frame.dimension, frame.dimension}, false);
}

void TrajectorySegments::append(const Frame& frame) {
  if (image_ == nullptr) open(frame);
  const std::string group = all;
  image_->append_row(group + "/position/step", std::vector<std::int64_t>{frame.step});
  image_->append_row(group + "/position/time", std::vector<double>{frame.time});
  image_->append_row(group + "/position/value", frame.position);
  image_->append_row(group + "/image/value", frame.image);
  image_->append_row(group + "/velocity/value", frame.velocity);
  if (!frame.spin.empty()) image_->append_row(group + "/angular_velocity/value", frame.spin);
  if (!frame.density.empty()) image_->append_row(group + "/density/value", frame.density);
  image_->append_row(group + "/box/edges/value", edge_vectors(frame));
  ++frames_;
}

void TrajectorySegments::write_single(const std::string& name, const Frame& frame) const {
  TrajectorySegments single(directory_, case_text_, version_, title_);
  single.append(frame);
  single.image_->save(directory_ / name);
}

void TrajectorySegments::save_segment() const {
  if (image_ != nullptr) image_->save(directory_ / segment_name(segment_));
}

void TrajectorySegments::close_segment() {
  if (image_ == nullptr) return;
  save_segment();
  image_.reset();
  frames_ = 0;
  ++segment_;
}

void TrajectorySegments::reopen(std::int64_t segment, std::int64_t frames) {
  segment_ = segment;
  frames_ = frames;
  image_.reset();
  if (frames == 0) return;
  const fs::path file = directory_ / segment_name(segment);
  image_ = std::make_unique<H5Image>(file);
  std::vector<const char*> columns{"position/step", "position/time",  "position/value",
                                   "image/value",   "velocity/value", "box/edges/value"};
  const H5Reader reader(file);
  if (reader.has(fmt::format("{}/angular_velocity", all)))
    columns.push_back("angular_velocity/value");
  if (reader.has(fmt::format("{}/density", all))) columns.push_back("density/value");
  // A later part may have written more of it.
  for (const char* rows : columns) {
    const std::string path = fmt::format("{}/{}", all, rows);
    if (const std::int64_t there = image_->rows(path); there < frames)
      throw IoError(fmt::format(
          "{}: has {} frames where the checkpoint knows {}: it was cut or replaced since; restore "
          "it, or continue into a new directory with --out",
          file.string(), there, frames));
    image_->keep_rows(path, frames);
  }
}

void TrajectorySegments::delete_later() const {
  std::error_code ignored;
  std::vector<fs::path> later;
  for (const auto& entry : fs::directory_iterator(directory_, ignored)) {
    const auto number = segment_number(entry.path().filename().string());
    if (number && (*number > segment_ || (*number == segment_ && image_ == nullptr)))
      later.push_back(entry.path());
  }
  for (const fs::path& file : later) remove_file(file);
}

}  // namespace odpd
