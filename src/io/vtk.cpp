#include "odpd/io/vtk.h"

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <string_view>

#include "odpd/io/file.h"

namespace odpd {

namespace {

using Text = fmt::memory_buffer;

template <class... Values>
void put(Text& text, fmt::format_string<Values...> format, Values&&... values) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
}

// Arrays a frame does not have are left out.

/// A flat array of vectors, filled up with zeros to the three components VTK wants.
void put_vectors(Text& text, std::string_view name, const std::vector<double>& values,
                 std::size_t dimension) {
  put(text, "<DataArray type=\"Float64\" Name=\"{}\" NumberOfComponents=\"3\" format=\"ascii\">\n",
      name);
  for (std::size_t first = 0; first + dimension <= values.size(); first += dimension) {
    for (std::size_t c = 0; c < 3; ++c) {
      put(text, "{}{}", c < dimension ? values[first + c] : 0.0, c < 2 ? ' ' : '\n');
    }
  }
  put(text, "</DataArray>\n");
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

}  // namespace

void write_vtp(const std::filesystem::path& file, const Frame& frame) {
  const std::size_t count = frame.id.size();
  const auto dimension = static_cast<std::size_t>(frame.dimension);
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
  if (!frame.velocity.empty()) put_vectors(text, "velocity", frame.velocity, dimension);
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

}  // namespace odpd
