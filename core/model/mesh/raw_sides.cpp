// What a file of Gmsh or VTK has beside a body: sides of its cells, points of no cell.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/model/mesh/raw_mesh.hpp"

namespace bb {
namespace {

template <std::size_t N>
using Side = std::array<long long, N>;

template <std::size_t N>
Side<N> sorted(Side<N> side) {
  std::sort(side.begin(), side.end());
  return side;
}

/// Faces of the tetrahedra, and how many have each.
std::map<Side<3>, int> faces_of(const RawMesh& raw) {
  std::map<Side<3>, int> out;
  for (const auto& [a, b, c, d] : raw.tetrahedra) {
    for (const Side<3>& face : {Side<3>{a, b, c}, {a, b, d}, {a, c, d}, {b, c, d}}) ++out[sorted(face)];
  }
  return out;
}

/// Without the triangles that are faces of tetrahedra; as a skin, those of one stay.
void drop_faces(RawMesh& raw, bool skin) {
  const std::map<Side<3>, int> faces = faces_of(raw);
  raw.keep_polygons([&](std::size_t p) {
    const std::size_t begin = raw.first_corner[p];
    if (raw.end_corner(p) - begin != 3) return true;
    const auto found =
        faces.find(sorted(Side<3>{raw.corners[begin], raw.corners[begin + 1], raw.corners[begin + 2]}));
    if (found == faces.end() || (skin && found->second == 1)) return true;
    count_one(raw.left_out, "a triangle that is a face of tetrahedra", raw.polygon_place[p]);
    return false;
  });
}

/// Without the lines that are among `sides`.
void drop_lines(RawMesh& raw, const std::set<Side<2>>& sides) {
  raw.keep_segments([&](std::size_t s) {
    if (!sides.contains(sorted(raw.segments[s]))) return true;
    count_one(raw.left_out, "a line that is a side of another cell", raw.segment_place[s]);
    return false;
  });
}

std::set<Side<2>> sides_of(const RawMesh& raw) {
  std::set<Side<2>> out;
  for (std::size_t p = 0; p < raw.n_polygons(); ++p) {
    const std::size_t begin = raw.first_corner[p], end = raw.end_corner(p);
    for (std::size_t c = begin; c < end; ++c) {
      out.insert(sorted(Side<2>{raw.corners[c], raw.corners[c + 1 < end ? c + 1 : begin]}));
    }
  }
  for (const auto& t : raw.tetrahedra) {
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) out.insert(sorted(Side<2>{t[i], t[j]}));
    }
  }
  return out;
}

/// Without the vertices of no cell. Corners that are no vertex stay so.
void drop_points(RawMesh& raw) {
  const auto n = static_cast<long long>(raw.vertices.size());
  std::vector<long long> number(raw.vertices.size(), -1);
  const auto use = [&](long long corner) {
    if (corner >= 0 && corner < n) number[static_cast<std::size_t>(corner)] = 0;
  };
  for (const long long corner : raw.corners) use(corner);
  for (const auto& cell : raw.segments) std::for_each(cell.begin(), cell.end(), use);
  for (const auto& cell : raw.tetrahedra) std::for_each(cell.begin(), cell.end(), use);

  RawMesh kept;
  for (std::size_t v = 0; v < raw.vertices.size(); ++v) {
    if (number[v] < 0) {
      count_one(raw.left_out, fmt::format("a {} of no cell", raw.vertex_element), raw.vertex_place[v]);
      continue;
    }
    number[v] = static_cast<long long>(kept.vertices.size());
    kept.add_vertex(raw.vertices[v], raw.vertex_place[v]);
    kept.numbers.push_back(raw.numbers.empty() ? static_cast<long long>(v) + raw.first_number
                                               : raw.numbers[v]);
  }
  const auto renumber = [&](long long& corner) {
    if (corner >= 0 && corner < n) corner = number[static_cast<std::size_t>(corner)];
  };
  for (long long& corner : raw.corners) renumber(corner);
  for (auto& cell : raw.segments) std::for_each(cell.begin(), cell.end(), renumber);
  for (auto& cell : raw.tetrahedra) std::for_each(cell.begin(), cell.end(), renumber);
  raw.vertices = std::move(kept.vertices);
  raw.vertex_place = std::move(kept.vertex_place);
  raw.numbers = std::move(kept.numbers);
  raw.fields.clear();
}

bool has_wrong_corner(const RawMesh& raw) {
  const auto n = static_cast<long long>(raw.vertices.size());
  const auto wrong = [n](long long corner) { return corner < 0 || corner >= n; };
  const auto any = [&](const auto& cell) { return std::any_of(cell.begin(), cell.end(), wrong); };
  return any(raw.corners) || std::any_of(raw.segments.begin(), raw.segments.end(), any) ||
         std::any_of(raw.tetrahedra.begin(), raw.tetrahedra.end(), any);
}

}  // namespace

RawMesh without_loose_vertices(RawMesh raw) {
  if (!has_wrong_corner(raw)) drop_points(raw);
  return raw;
}

RawMesh without_sides(RawMesh raw, bool skin) {
  if (has_wrong_corner(raw)) return raw;  // refused later, by the numbers of the file
  const std::set<Side<2>> sides = sides_of(raw);
  drop_faces(raw, skin);
  drop_lines(raw, sides);
  drop_points(raw);
  return raw;
}

}  // namespace bb
