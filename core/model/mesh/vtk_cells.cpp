#include "core/model/mesh/vtk_cells.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/math/error.hpp"

namespace bb {
namespace {

enum class VtkKind { nothing, points, line, chain, strip, polygon, pixel, tetrahedron, other };

struct VtkType {
  long long number;
  const char* name;
  VtkKind kind;
  std::size_t corners;  // 0: any number
};

// Of the types of Lagrange and Bezier those of first order are like the plain ones (FEniCSx writes all cells so).
constexpr VtkType vtk_types[] = {
    {0, "empty cell", VtkKind::nothing, 0},
    {1, "vertex", VtkKind::points, 0},
    {2, "vertices", VtkKind::points, 0},
    {3, "line", VtkKind::line, 2},
    {4, "polyline", VtkKind::chain, 0},
    {5, "triangle", VtkKind::polygon, 3},
    {6, "triangle strip", VtkKind::strip, 0},
    {7, "polygon", VtkKind::polygon, 0},
    {8, "pixel", VtkKind::pixel, 4},
    {9, "quad", VtkKind::polygon, 4},
    {10, "tetrahedron", VtkKind::tetrahedron, 4},
    {11, "voxel", VtkKind::other, 8},
    {12, "hexahedron", VtkKind::other, 8},
    {13, "wedge", VtkKind::other, 6},
    {14, "pyramid", VtkKind::other, 5},
    {15, "pentagonal prism", VtkKind::other, 10},
    {16, "hexagonal prism", VtkKind::other, 12},
    {21, "quadratic edge", VtkKind::other, 3},
    {22, "quadratic triangle", VtkKind::other, 6},
    {23, "quadratic quad", VtkKind::other, 8},
    {24, "quadratic tetrahedron", VtkKind::other, 10},
    {25, "quadratic hexahedron", VtkKind::other, 20},
    {26, "quadratic wedge", VtkKind::other, 15},
    {27, "quadratic pyramid", VtkKind::other, 13},
    {28, "biquadratic quad", VtkKind::other, 9},
    {29, "triquadratic hexahedron", VtkKind::other, 27},
    {34, "biquadratic triangle", VtkKind::other, 7},
    {35, "cubic line", VtkKind::other, 4},
    {36, "quadratic polygon", VtkKind::other, 0},
    {42, "polyhedron", VtkKind::other, 0},
    {68, "Lagrange curve", VtkKind::line, 2},
    {69, "Lagrange triangle", VtkKind::polygon, 3},
    {70, "Lagrange quad", VtkKind::polygon, 4},
    {71, "Lagrange tetrahedron", VtkKind::tetrahedron, 4},
    {72, "Lagrange hexahedron", VtkKind::other, 0},
    {73, "Lagrange wedge", VtkKind::other, 0},
    {74, "Lagrange pyramid", VtkKind::other, 0},
    {75, "Bezier curve", VtkKind::line, 2},
    {76, "Bezier triangle", VtkKind::polygon, 3},
    {77, "Bezier quad", VtkKind::polygon, 4},
    {78, "Bezier tetrahedron", VtkKind::tetrahedron, 4},
};

constexpr const char* vtk_allowed =
    "cells of first order: vertex, line, polyline, triangle, triangle strip, polygon, pixel, quad, "
    "tetrahedron";

void close(RawMesh& mesh, std::initializer_list<long long> corners, long long place) {
  const std::size_t first = mesh.corners.size();
  mesh.corners.insert(mesh.corners.end(), corners);
  mesh.close_polygon(first, place);
}

void add_kind(RawMesh& mesh, VtkKind kind, std::span<const long long> corners, long long place) {
  switch (kind) {
    case VtkKind::line:
    case VtkKind::chain:
      for (std::size_t k = 1; k < corners.size(); ++k) mesh.add_segment(corners[k - 1], corners[k], place);
      return;
    case VtkKind::strip:
      return mesh.add_strip({corners.begin(), corners.end()}, place);
    case VtkKind::pixel:  // its corners run along the axes
      return close(mesh, {corners[0], corners[1], corners[3], corners[2]}, place);
    case VtkKind::polygon:
    case VtkKind::tetrahedron: {
      const std::size_t first = mesh.corners.size();
      mesh.corners.insert(mesh.corners.end(), corners.begin(), corners.end());
      if (kind == VtkKind::polygon) return mesh.close_polygon(first, place);
      return mesh.close_tetrahedron(first, place);
    }
    case VtkKind::nothing:
    case VtkKind::points:
    case VtkKind::other:
      return;
  }
}

}  // namespace

void add_vtk_cell(RawMesh& mesh, long long type, std::span<const long long> corners, long long place) {
  const auto* found = std::find_if(std::begin(vtk_types), std::end(vtk_types),
                                   [&](const VtkType& one) { return one.number == type; });
  const bool known = found != std::end(vtk_types);
  if (!known || found->kind == VtkKind::other) {
    throw ConfigError(mesh.where("cell", place),
                      known ? fmt::format("a {} (type {})", found->name, type)
                            : fmt::format("a cell of type {}, which VTK does not have", type),
                      vtk_allowed);
  }
  if (found->corners > 0 && corners.size() != found->corners) {
    throw ConfigError(mesh.where("cell", place),
                      fmt::format("a {} (type {}) of {} corners", found->name, type, corners.size()),
                      fmt::format("{} corners", found->corners));
  }
  if (found->kind == VtkKind::nothing || found->kind == VtkKind::points) {
    return count_one(mesh.left_out, fmt::format("cell \"{}\"", found->name), place);
  }
  add_kind(mesh, found->kind, corners, place);
}

void add_vtk_cells(RawMesh& mesh, const std::vector<long long>& corners, const std::vector<long long>& ends,
                   const std::vector<long long>& types, long long base, long long first) {
  if (ends.size() != types.size()) {
    throw ConfigError(mesh.name, fmt::format("{} ends of cells and {} types", ends.size(), types.size()),
                      "as many of both");
  }
  long long begin = 0;
  std::vector<long long> cell;
  for (std::size_t k = 0; k < ends.size(); ++k) {
    const auto place = first + static_cast<long long>(k);
    if (ends[k] < begin || ends[k] > static_cast<long long>(corners.size())) {
      throw ConfigError(mesh.where("cell", place), fmt::format("a cell from corner {} to {}", begin, ends[k]),
                        fmt::format("corners in order, of {}", corners.size()));
    }
    cell.assign(corners.begin() + begin, corners.begin() + ends[k]);
    for (long long& corner : cell) corner += base;
    add_vtk_cell(mesh, types[k], cell, place);
    begin = ends[k];
  }
  if (begin != static_cast<long long>(corners.size())) {
    throw ConfigError(
        mesh.name,
        fmt::format("{} corners behind the last cell", static_cast<long long>(corners.size()) - begin),
        "corners of cells alone");
  }
}

void VtkFields::add(RawMesh& mesh, const std::string& name, long long components, std::vector<double> values,
                    std::size_t n) const {
  if (components < 1 || components > 3) return;
  const bool wanted = is_wanted(name);
  const std::size_t before = mesh.vertices.size() - n;
  auto found = std::find_if(mesh.fields.begin(), mesh.fields.end(),
                            [&](const PointField& field) { return field.name == name; });
  if (found == mesh.fields.end()) {
    if (wanted && before > 0) {
      throw ConfigError(mesh.name, fmt::format("no field \"{}\" of the first {} points", name, before),
                        "a field of all points");
    }
    mesh.fields.push_back({name, static_cast<int>(components), {}});
    found = mesh.fields.end() - 1;
  }
  if (!wanted) return;
  const auto width = static_cast<std::size_t>(found->components);
  if (found->components != components || values.size() != n * width ||
      found->values.size() != before * width) {
    throw ConfigError(mesh.name,
                      fmt::format("{} numbers of {} components in the field \"{}\" of {} points",
                                  values.size(), components, name, n),
                      fmt::format("{} components of each point, in each part of the file", width));
  }
  found->values.insert(found->values.end(), values.begin(), values.end());
}

}  // namespace bb
