#include "odpd/io/vtk.h"

#include <fmt/format.h>

#include <iterator>
#include <set>
#include <string>
#include <string_view>

#include "odpd/core/index.h"
#include "odpd/io/file.h"

namespace odpd {

namespace fs = std::filesystem;

namespace {

using Text = fmt::memory_buffer;

template <class... Values>
void put(Text& text, fmt::format_string<Values...> format, Values&&... values) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
}

// Arrays a frame does not have are left out.

/// A flat array of vectors, filled up with zeros to the three components VTK wants: behind those given, or before them.
void put_vectors(Text& text, std::string_view name, const std::vector<double>& values,
                 std::size_t dimension, std::size_t first_given = 0) {
  if (values.empty()) return;
  put(text, "<DataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"3\" format=\"ascii\">\n",
      name);
  for (std::size_t first = 0; first + dimension <= values.size(); first += dimension) {
    for (std::size_t c = 0; c < 3; ++c) {
      const bool given = c >= first_given && c < first_given + dimension;
      put(text, "{}{}", given ? values[first + c - first_given] : 0.0, c < 2 ? ' ' : '\n');
    }
  }
  put(text, "</DataArray>\n");
}

void put_numbers(Text& text, std::string_view name, const std::vector<double>& values) {
  if (values.empty()) return;
  put(text, "<DataArray type=\"Float64\" Name=\"{}\" format=\"ascii\">\n{}\n</DataArray>\n", name,
      fmt::join(values, " "));
}

void put_integers(Text& text, std::string_view name, const std::vector<std::int64_t>& values) {
  if (values.empty()) return;
  put(text, "<DataArray type=\"Int64\" Name=\"{}\" format=\"ascii\">\n{}\n</DataArray>\n", name,
      fmt::join(values, " "));
}

/// Each particle is one vertex cell, or ParaView would show nothing.
void put_vertices(Text& text, std::size_t count) {
  put(text, "<Verts>\n<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">\n");
  for (std::size_t p = 0; p < count; ++p) put(text, "{} ", p);
  put(text, "\n</DataArray>\n<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">\n");
  for (std::size_t p = 0; p < count; ++p) put(text, "{} ", p + 1);
  put(text, "\n</DataArray>\n</Verts>\n");
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char letter : text) {
    switch (letter) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += letter;
    }
  }
  return result;
}

std::string frame_name(std::int64_t step) { return fmt::format("frames/{:010}.vtp", step); }

bool is_frame_name(const std::string& name) {
  const fs::path path(name);
  const std::string stem = path.stem().string();
  return path.extension() == ".vtp" && stem.size() >= 10 &&
         stem.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

void write_vtp(const std::filesystem::path& file, const Frame& frame) {
  const std::size_t count = frame.id.size();
  const auto dimension = index(frame.dimension);
  Text text;
  put(text,
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n<PolyData>\n"
      "<FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" "
      "format=\"ascii\">{}</DataArray>\n</FieldData>\n",
      frame.time);
  put(text, "<Piece NumberOfPoints=\"{0}\" NumberOfVerts=\"{0}\">\n<Points>\n", count);
  put_vectors(text, "position", frame.position, dimension);
  put(text, "</Points>\n");
  put_vertices(text, count);
  put(text, "<PointData>\n");
  put_vectors(text, "velocity", frame.velocity, dimension);
  // That of a plane is about z.
  put_vectors(text, "angular_velocity", frame.spin, dimension == 2 ? 1 : 3, dimension == 2 ? 2 : 0);
  put_numbers(text, "density", frame.density);
  put_integers(text, "id", frame.id);
  put_integers(text, "species", frame.species);
  put_integers(text, "group", frame.group);
  put(text, "</PointData>\n</Piece>\n</PolyData>\n</VTKFile>\n");
  write_file_atomically(file, std::string_view(text.data(), text.size()));
}

void write_pvd(const std::filesystem::path& file,
               const std::vector<std::pair<double, std::string>>& frames) {
  Text text;
  put(text,
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n<Collection>\n");
  for (const auto& [time, name] : frames) {
    put(text, "<DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", time, escaped(name));
  }
  put(text, "</Collection>\n</VTKFile>\n");
  write_file_atomically(file, std::string_view(text.data(), text.size()));
}

VtkFrames::VtkFrames(std::filesystem::path directory) : directory_(std::move(directory)) {}

void VtkFrames::write(const Frame& frame) const {
  make_directory(directory_ / "frames");
  write_vtp(directory_ / frame_name(frame.step), frame);
}

void VtkFrames::write_collection(std::vector<double> times, std::vector<std::int64_t> steps) const {
  std::vector<std::pair<double, std::string>> frames;
  for (std::size_t k = 0; k < times.size(); ++k)
    frames.emplace_back(times[k], frame_name(steps.at(k)));
  write_pvd(directory_ / "particles.pvd", frames);
}

void VtkFrames::append(const Frame& frame) {
  write(frame);
  times_.push_back(frame.time);
  steps_.push_back(frame.step);
  write_collection(times_, steps_);
}

void VtkFrames::append_last(const Frame& frame) {
  if (!steps_.empty() && steps_.back() == frame.step) return;
  write(frame);
  auto times = times_;
  auto steps = steps_;
  times.push_back(frame.time);
  steps.push_back(frame.step);
  write_collection(std::move(times), std::move(steps));
}

void VtkFrames::resume_at(const std::vector<double>& times,
                          const std::vector<std::int64_t>& steps) {
  times_ = times;
  steps_ = steps;
  std::set<std::string> kept;
  for (const std::int64_t step : steps_) kept.insert(frame_name(step));
  std::error_code error;
  if (!steps_.empty()) {
    write_collection(times_, steps_);
  } else if (fs::exists(directory_ / "particles.pvd", error)) {
    remove_file(directory_ / "particles.pvd");
  }
  std::vector<fs::path> others;
  for (const auto& entry : fs::directory_iterator(directory_ / "frames", error)) {
    const std::string name = "frames/" + entry.path().filename().string();
    if (is_frame_name(name) && !kept.contains(name)) others.push_back(entry.path());
  }
  for (const fs::path& file : others) remove_file(file);
}

}  // namespace odpd
