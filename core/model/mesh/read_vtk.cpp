// Legacy files of VTK (.vtk), ascii and binary (big-endian): unstructured grids and polygons, versions 1 to 5.1.
#include <fmt/format.h>

#include <algorithm>

#include "core/math/error.hpp"
#include "core/model/mesh/mixed_source.hpp"
#include "core/model/mesh/vtk_cells.hpp"

namespace bb {
namespace {

/// Of numbers, as these files name it.
const NumberType& legacy_type(const MixedSource& in, std::string_view name) {
  const NumberType* type = number_type_of(name);
  if (type == nullptr)
    in.fail(fmt::format("numbers of type \"{}\"", name), "a type of VTK: float, double, int, vtkIdType, ...");
  return *type;
}

/// The first word of a line in capitals: a keyword.
std::string keyword(const MixedSource& in) {
  std::string out(in.word(0));
  for (char& c : out) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return out;
}

struct LegacyCells {
  std::vector<long long> corners, ends;
};

class LegacyVtk {
 public:
  LegacyVtk(const std::string& bytes, const std::string& name, const FieldNames& wanted)
      : in_(bytes, name), fields_(wanted) {
    mesh_.name = name;
    mesh_.places_are_lines = false;
    mesh_.cell_element = "cell";
  }

  RawMesh run() {
    read_header();
    while (in_.next_line()) take(keyword(in_));
    if (types_.size() != cells_.ends.size()) {
      throw ConfigError(mesh_.name, fmt::format("{} cells and {} types", cells_.ends.size(), types_.size()),
                        "as many of both");
    }
    add_vtk_cells(mesh_, cells_.corners, cells_.ends, types_, 0, 0);
    return std::move(mesh_);
  }

 private:
  void read_header() {
    if (!in_.next_line() || !in_.line().starts_with("# vtk DataFile"))
      in_.fail("no first line of VTK", "# vtk DataFile Version ...");
    in_.skip_line();  // the title
    if (!in_.next_line() || (keyword(in_) != "ASCII" && keyword(in_) != "BINARY"))
      in_.fail("no format", "ASCII or BINARY");
    if (keyword(in_) == "BINARY") in_.set_binary(true);
    const bool said = in_.next_line() && keyword(in_) == "DATASET";
    if (!said || (in_.word(1) != "UNSTRUCTURED_GRID" && in_.word(1) != "POLYDATA")) {
      in_.fail(fmt::format("\"{} {}\"", in_.word(0), in_.word(1)), "DATASET UNSTRUCTURED_GRID or POLYDATA");
    }
  }

  void take(const std::string& key) {
    static const std::map<std::string, long long> polygons{
        {"VERTICES", 2}, {"LINES", 4}, {"TRIANGLE_STRIPS", 6}, {"POLYGONS", 7}};
    if (key == "POINTS") {
      const std::vector<double> x = in_.numbers<double>(3 * in_.size(1), legacy_type(in_, in_.word(2)));
      for (std::size_t i = 0; i + 2 < x.size(); i += 3) {
        mesh_.add_vertex({x[i], x[i + 1], x[i + 2]}, static_cast<long long>(i / 3));
      }
    } else if (key == "CELLS") {
      append(read_cells());
    } else if (key == "CELL_TYPES") {
      const std::vector<long long> types = in_.numbers<long long>(in_.size(1), legacy_type(in_, "int"));
      types_.insert(types_.end(), types.begin(), types.end());
    } else if (const auto found = polygons.find(key); found != polygons.end()) {
      types_.insert(types_.end(), append(read_cells()), found->second);
    } else if (key == "POINT_DATA" || key == "CELL_DATA") {
      of_points_ = key == "POINT_DATA";
      tuples_ = in_.size(1);
    } else if (key == "METADATA") {
      in_.skip_block();
    } else {
      take_attribute(key);
    }
  }

  /// How many cells were added.
  std::size_t append(const LegacyCells& more) {
    const auto before = static_cast<long long>(cells_.corners.size());
    for (const long long end : more.ends) cells_.ends.push_back(before + end);
    cells_.corners.insert(cells_.corners.end(), more.corners.begin(), more.corners.end());
    return more.ends.size();
  }

  /// "CELLS cells numbers" with counts between the corners, or since version 5 "CELLS offsets corners" and two lists.
  LegacyCells read_cells() {
    const long long n = in_.size(1), size = in_.size(2);
    MixedSource ahead = in_;
    if (ahead.next_line() && keyword(ahead) == "OFFSETS") return read_offsets(n, size);
    const std::vector<long long> numbers = in_.numbers<long long>(size, legacy_type(in_, "int"));
    LegacyCells out;
    std::size_t at = 0;
    for (long long k = 0; k < n; ++k) {
      const long long corners = at < numbers.size() ? numbers[at] : -1;
      if (corners < 0 || corners > static_cast<long long>(numbers.size() - at - 1)) {
        in_.fail(fmt::format("cell {} of {} corners", k, corners),
                 fmt::format("cells within {} numbers", size));
      }
      const auto first = numbers.begin() + static_cast<std::ptrdiff_t>(at) + 1;
      out.corners.insert(out.corners.end(), first, first + corners);
      out.ends.push_back(static_cast<long long>(out.corners.size()));
      at += static_cast<std::size_t>(corners) + 1;
    }
    if (at != numbers.size())
      in_.fail(fmt::format("{} numbers behind the last cell", numbers.size() - at), "cells alone");
    return out;
  }

  LegacyCells read_offsets(long long n, long long size) {
    LegacyCells out;
    in_.next_line();
    out.ends = in_.numbers<long long>(n, legacy_type(in_, in_.word(1)));
    if (!in_.next_line() || keyword(in_) != "CONNECTIVITY")
      in_.fail("no CONNECTIVITY", "CONNECTIVITY behind OFFSETS");
    out.corners = in_.numbers<long long>(size, legacy_type(in_, in_.word(1)));
    if (!out.ends.empty()) {
      if (out.ends.front() != 0) in_.fail(fmt::format("the first offset {}", out.ends.front()), "0");
      out.ends.erase(out.ends.begin());
    }
    return out;
  }

  void take_attribute(const std::string& key) {
    const std::string name(in_.word(1));
    if (key == "VECTORS" || key == "NORMALS") {
      take_field(name, 3, tuples_, in_.word(2));
    } else if (key == "TENSORS" || key == "TENSORS6") {
      take_field(name, key == "TENSORS" ? 9 : 6, tuples_, in_.word(2));
    } else if (key == "TEXTURE_COORDINATES") {
      take_field(name, in_.size(2), tuples_, in_.word(3));
    } else if (key == "SCALARS") {
      const std::string type(in_.word(2));
      const long long components = in_.words() > 3 ? in_.size(3) : 1;
      MixedSource ahead = in_;
      if (ahead.next_line() && keyword(ahead) == "LOOKUP_TABLE") in_ = ahead;
      take_field(name, components, tuples_, type);
    } else if (key == "LOOKUP_TABLE") {
      skip_colors(4, in_.size(2));
    } else if (key == "COLOR_SCALARS") {
      skip_colors(in_.size(2), tuples_);
    } else if (key == "GLOBAL_IDS" || key == "PEDIGREE_IDS") {
      in_.numbers<double>(tuples_, legacy_type(in_, in_.word(2)));
    } else if (key == "FIELD") {
      for (long long n = in_.size(2); n > 0; --n) take_array();
    } else {
      in_.fail(fmt::format("\"{}\"", in_.word(0).substr(0, 40)), "a keyword of the legacy format of VTK");
    }
  }

  void take_array() {
    do {
      if (!in_.next_line()) in_.fail("the end of the file", "as many arrays as FIELD states");
      if (keyword(in_) == "METADATA") in_.skip_block();
    } while (keyword(in_) == "METADATA");
    const std::string name(in_.word(0));
    if (in_.word(3) == "string") in_.fail("an array of strings", "arrays of numbers");
    take_field(name, in_.size(1), in_.size(2), in_.word(3));
  }

  void take_field(const std::string& name, long long components, long long tuples, std::string_view type) {
    if (components > 1000) in_.fail(fmt::format("{} components", components), "at most 1000");
    std::vector<double> values = in_.numbers<double>(components * tuples, legacy_type(in_, type));
    const bool is_real = type == "float" || type == "double";
    if (!of_points_ || !is_real || tuples != static_cast<long long>(mesh_.vertices.size())) return;
    if (!fields_.is_wanted(name)) values.clear();
    fields_.add(mesh_, name, components, std::move(values), mesh_.vertices.size());
  }

  /// Bytes in binary files, numbers from 0 to 1 in ascii.
  void skip_colors(long long components, long long tuples) {
    if (components > 1000) in_.fail(fmt::format("{} components", components), "at most 1000");
    in_.numbers<double>(components * tuples, legacy_type(in_, "unsigned_char"));
  }

  MixedSource in_;
  VtkFields fields_;
  RawMesh mesh_;
  LegacyCells cells_;
  std::vector<long long> types_;
  bool of_points_ = false;
  long long tuples_ = 0;
};

}  // namespace

RawMesh parse_vtk(const std::string& bytes, const std::string& name, const FieldNames& wanted) {
  return LegacyVtk(bytes, name, wanted).run();
}

}  // namespace bb
