#include "core/model/mesh/frame_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "core/math/error.hpp"
#include "core/model/mesh/polygon_cut.hpp"
#include "core/model/mesh/raw_mesh.hpp"

namespace bb {
namespace {

class FrameBuilder {
 public:
  explicit FrameBuilder(RawMesh raw) : raw_(std::move(raw)) {}

  FrameMesh run() {
    copy_vertices();
    for (std::size_t p = 0; p < raw_.n_polygons(); ++p) add_polygon(p);
    for (std::size_t s = 0; s < raw_.segments.size(); ++s) {
      mesh_.segments.push_back(checked(raw_.segments[s], "edge", raw_.segment_place[s]));
    }
    for (std::size_t t = 0; t < raw_.tetrahedra.size(); ++t) {
      mesh_.tetrahedra.push_back(checked(raw_.tetrahedra[t], "tetrahedron", raw_.tetrahedron_place[t]));
    }
    copy_uvs();
    for (PointField& field : raw_.fields) {
      mesh_.fields.push_back({std::move(field.name), field.components, std::move(field.values)});
    }
    mesh_.notes = notes_of(raw_);
    for (const auto& [what, kind] : crossed_) {
      mesh_.notes.push_back(note_of(raw_, what, kind, "cut into triangles from the first corner"));
    }
    return std::move(mesh_);
  }

 private:
  void copy_vertices() {
    const std::size_t n = raw_.vertices.size();
    if (n == 0) throw ConfigError(raw_.name, "no vertex", "at least one vertex");
    if (n > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      throw ConfigError(raw_.name, fmt::format("{} vertices", n), "at most 2147483647 vertices");
    }
    mesh_.vertices.resize(3, static_cast<Eigen::Index>(n));
    for (std::size_t i = 0; i < n; ++i) mesh_.vertices.col(static_cast<Eigen::Index>(i)) = raw_.vertices[i];
  }

  void copy_uvs() {
    for (const Vec2d& uv : raw_.uvs) mesh_.uvs.push_back({uv[0], uv[1]});
    for (std::size_t p = 0; p < raw_.n_polygons() && !raw_.corner_uvs.empty(); ++p) {
      for (std::size_t c = raw_.first_corner[p]; c < raw_.end_corner(p); ++c) {
        const long long uv = raw_.corner_uvs[c];
        if (uv >= static_cast<long long>(raw_.uvs.size())) {
          throw ConfigError(raw_.where("face", raw_.polygon_place[p]),
                            fmt::format("the texture coordinate {}", uv + 1),
                            fmt::format("one of the {} of the file", raw_.uvs.size()));
        }
        mesh_.corner_uvs.push_back(static_cast<int>(uv));
      }
    }
  }

  int checked(long long corner, const char* element, long long place) const {
    if (corner >= 0 && corner < static_cast<long long>(raw_.vertices.size())) return static_cast<int>(corner);
    throw ConfigError(raw_.where(element, place), raw_.vertex_found(corner), raw_.vertices_allowed());
  }

  template <std::size_t N>
  std::array<int, N> checked(const std::array<long long, N>& corners, const char* element,
                             long long place) const {
    std::array<int, N> out{};
    for (std::size_t k = 0; k < N; ++k) out[k] = checked(corners[k], element, place);
    check_distinct({out.begin(), out.end()}, element, place);
    return out;
  }

  void check_distinct(std::vector<int> corners, const char* element, long long place) const {
    std::sort(corners.begin(), corners.end());
    const auto twice = std::adjacent_find(corners.begin(), corners.end());
    if (twice == corners.end()) return;
    throw ConfigError(raw_.where(element, place),
                      fmt::format("{} with {} twice", element, raw_.vertex_found(*twice)),
                      "distinct corners");
  }

  void add_polygon(std::size_t p) {
    const long long place = raw_.polygon_place[p];
    std::vector<int> polygon;
    for (std::size_t c = raw_.first_corner[p]; c < raw_.end_corner(p); ++c) {
      polygon.push_back(checked(raw_.corners[c], "face", place));
    }
    if (polygon.size() < 3) {
      throw ConfigError(raw_.where("face", place), fmt::format("{} corners", polygon.size()),
                        "at least 3 corners");
    }
    check_distinct(polygon, "face", place);
    std::optional<Triangles> cut = cut_of(mesh_.vertices, polygon);
    if (!cut) {
      count_one(crossed_, "a polygon whose sides cross", place);
      cut = Triangles();
      for (std::size_t k = 2; k < polygon.size(); ++k)
        cut->push_back({polygon[0], polygon[k - 1], polygon[k]});
    }
    mesh_.triangles.insert(mesh_.triangles.end(), cut->begin(), cut->end());
    mesh_.corners.insert(mesh_.corners.end(), polygon.begin(), polygon.end());
    mesh_.sizes.push_back(static_cast<int>(polygon.size()));
  }

  RawMesh raw_;
  FrameMesh mesh_;
  std::map<std::string, LeftOut> crossed_;
};

}  // namespace

FrameMesh parse_frame(const std::string& bytes, const std::string& name, const FieldNames& fields, bool uvs) {
  FrameMesh mesh = FrameBuilder(parse_raw(bytes, name, fields, uvs)).run();
  for (const std::string& wanted : fields) {
    const auto found = std::find_if(mesh.fields.begin(), mesh.fields.end(),
                                    [&](const FrameField& field) { return field.name == wanted; });
    if (found != mesh.fields.end()) {
      const auto n =
          static_cast<std::size_t>(mesh.vertices.cols()) * static_cast<std::size_t>(found->components);
      if (found->values.size() == n) continue;
      throw ConfigError(name, fmt::format("{} numbers in the field \"{}\"", found->values.size(), wanted),
                        fmt::format("{}: {} of each point", n, found->components));
    }
    std::string names;
    for (const FrameField& field : mesh.fields) names += (names.empty() ? "" : ", ") + field.name;
    throw ConfigError(name, fmt::format("no field \"{}\" of points", wanted),
                      names.empty() ? "a file with fields of points (VTK)" : names);
  }
  return mesh;
}

}  // namespace bb
