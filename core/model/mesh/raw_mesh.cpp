// The rules every mesh obeys, whatever file it came from.
#include "core/model/mesh/raw_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "core/math/error.hpp"
#include "core/model/mesh/bounds.hpp"
#include "core/model/mesh/polygon_cut.hpp"
#include "core/model/mesh/topology.hpp"

namespace bb {

void RawMesh::add_vertex(const Vec3d& x, long long place) {
  vertices.push_back(x);
  vertex_place.push_back(place);
}
void RawMesh::close_polygon(std::size_t first, long long place) {
  first_corner.push_back(first);
  polygon_place.push_back(place);
}
void RawMesh::add_strip(const std::vector<long long>& strip, long long place) {
  for (std::size_t k = 2; k < strip.size(); ++k) {
    const long long a = strip[k - 2 + k % 2], b = strip[k - 1 - k % 2], c = strip[k];
    if (a == b || b == c || a == c) continue;
    const std::size_t first = corners.size();
    corners.insert(corners.end(), {a, b, c});
    close_polygon(first, place);
  }
}
void RawMesh::add_segment(long long a, long long b, long long place) {
  segments.push_back({a, b});
  segment_place.push_back(place);
}
void RawMesh::keep_polygons(const std::function<bool(std::size_t)>& keep) {
  RawMesh kept;
  for (std::size_t p = 0; p < n_polygons(); ++p) {
    if (!keep(p)) continue;
    const std::size_t first = kept.corners.size();
    for (std::size_t c = first_corner[p]; c < end_corner(p); ++c) {
      kept.corners.push_back(corners[c]);
      if (!corner_uvs.empty()) kept.corner_uvs.push_back(corner_uvs[c]);
    }
    kept.close_polygon(first, polygon_place[p]);
    if (!polygon_objects.empty()) kept.polygon_objects.push_back(polygon_objects[p]);
  }
  corners = std::move(kept.corners);
  corner_uvs = std::move(kept.corner_uvs);
  first_corner = std::move(kept.first_corner);
  polygon_place = std::move(kept.polygon_place);
  polygon_objects = std::move(kept.polygon_objects);
}
void RawMesh::keep_segments(const std::function<bool(std::size_t)>& keep) {
  RawMesh kept;
  for (std::size_t s = 0; s < segments.size(); ++s) {
    if (!keep(s)) continue;
    kept.add_segment(segments[s][0], segments[s][1], segment_place[s]);
    if (!segment_objects.empty()) kept.segment_objects.push_back(segment_objects[s]);
  }
  segments = std::move(kept.segments);
  segment_place = std::move(kept.segment_place);
  segment_objects = std::move(kept.segment_objects);
}
std::string note_of(const RawMesh& raw, const std::string& what, const LeftOut& kind, const char* done) {
  return fmt::format("{}: {} {}, the first at {}", what, kind.count, done, raw.where("element", kind.place));
}

std::vector<std::string> notes_of(const RawMesh& raw) {
  std::vector<std::string> notes;
  for (const auto& [what, kind] : raw.unread) {
    notes.push_back(note_of(raw, what, kind, "not understood and left out"));
  }
  for (const auto& [what, kind] : raw.left_out) notes.push_back(note_of(raw, what, kind, "left out"));
  return notes;
}

void RawMesh::close_tetrahedron(std::size_t first, long long place) {
  if (corners.size() != first + 4) {
    throw ConfigError(where("tetrahedron", place), fmt::format("{} corners", corners.size() - first),
                      "4 corners");
  }
  tetrahedra.push_back({corners[first], corners[first + 1], corners[first + 2], corners[first + 3]});
  tetrahedron_place.push_back(place);
  corners.resize(first);
}
std::size_t RawMesh::end_corner(std::size_t polygon) const {
  return polygon + 1 < first_corner.size() ? first_corner[polygon + 1] : corners.size();
}
std::string RawMesh::where(const char* element, long long place) const {
  if (places_are_lines) return fmt::format("{}:{}", name, place);
  const bool of_cell = cell_element != nullptr && element != std::string_view(vertex_element);
  return fmt::format("{}: {} {}", name, of_cell ? cell_element : element, place);
}
std::string RawMesh::vertex_found(long long index) const {
  const bool listed = index >= 0 && index < static_cast<long long>(numbers.size());
  return fmt::format("{} {}", numbers.empty() ? "vertex" : vertex_element,
                     listed ? numbers[static_cast<std::size_t>(index)] : index + first_number);
}
std::string RawMesh::vertices_allowed() const {
  const auto n = static_cast<long long>(vertices.size());
  return n == 0 ? "a file with vertices"
                : fmt::format("a vertex from {} to {}", first_number, n - 1 + first_number);
}

void count_one(std::map<std::string, LeftOut>& kinds, const std::string& what, long long place) {
  LeftOut& kind = kinds[what];
  if (kind.count++ == 0) kind.place = place;
}

namespace {

constexpr std::size_t max_violations = 20;  // enough to see a pattern, few enough to read

class Assembler {
 public:
  explicit Assembler(const RawMesh& raw) : raw_(raw) {}

  TriangleMesh run() {
    for (const auto& [what, kind] : raw_.unread) {
      complain("element", kind.place, what, "what a file of this format has");
    }
    copy_vertices();
    for (std::size_t p = 0; p < raw_.first_corner.size(); ++p) add_polygon(p);
    for (std::size_t s = 0; s < raw_.segments.size(); ++s) add_segment(s);
    for (std::size_t t = 0; t < raw_.tetrahedra.size(); ++t) add_tetrahedron(t);
    if (!violations_.empty()) throw ConfigError(std::move(violations_));
    return std::move(mesh_);
  }

 private:
  void complain(const char* element, long long place, std::string found, std::string allowed) {
    if (violations_.size() >= max_violations) return;
    violations_.push_back({raw_.where(element, place), std::move(found), std::move(allowed)});
  }

  void copy_vertices() {
    const std::size_t n = raw_.vertices.size();
    if (n == 0) violations_.push_back({raw_.name, "no vertex", "at least one vertex"});
    if (n > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      throw ConfigError(raw_.name, fmt::format("{} vertices", n), "at most 2147483647 vertices");
    }
    mesh_.vertices.resize(3, static_cast<Eigen::Index>(n));
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3d& x = raw_.vertices[i];
      if (!(x.cwiseAbs().maxCoeff<Eigen::PropagateNaN>() <= max_coordinate)) {
        complain(raw_.vertex_element, raw_.vertex_place[i], fmt::format("({}, {}, {})", x[0], x[1], x[2]),
                 fmt::format("finite coordinates between -{0:g} and {0:g}", max_coordinate));
      }
      mesh_.vertices.col(static_cast<Eigen::Index>(i)) = x;
    }
  }

  bool in_range(const char* element, long long index, long long place) {
    if (index >= 0 && index < static_cast<long long>(raw_.vertices.size())) return true;
    complain(element, place, raw_.vertex_found(index), raw_.vertices_allowed());
    return false;
  }

  void add_polygon(std::size_t p) {
    const long long place = raw_.polygon_place[p];
    const std::size_t begin = raw_.first_corner[p];
    const std::size_t end = raw_.end_corner(p);
    std::vector<int> polygon;
    for (std::size_t c = begin; c < end; ++c) {
      if (!in_range("face", raw_.corners[c], place)) return;
      polygon.push_back(static_cast<int>(raw_.corners[c]));
    }
    if (polygon.size() < 3) {
      return complain("face", place, fmt::format("{} corners", polygon.size()), "at least 3 corners");
    }
    std::vector<int> sorted = polygon;
    std::sort(sorted.begin(), sorted.end());
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice != sorted.end()) {
      return complain("face", place, fmt::format("a face with {} twice", raw_.vertex_found(*twice)),
                      "distinct corners");
    }
    const auto [other, is_new] = faces_.try_emplace(std::move(sorted), place);
    if (!is_new) {
      return complain("face", place, fmt::format("the same corners as at {}", other->second),
                      "each face once");
    }
    add_fan(polygon, place);
  }

  void add_fan(const std::vector<int>& polygon, long long place) {
    for (std::size_t k = 2; k < polygon.size(); ++k) {
      // a corner beyond max_coordinate was complained about
      if (!area_vector(mesh_.vertices, {polygon[0], polygon[k - 1], polygon[k]}).allFinite()) return;
    }
    const std::optional<Triangles> fan = fan_of(mesh_.vertices, polygon);
    if (!fan && has_flat_corner(mesh_.vertices, polygon)) {
      return complain("face", place, "a face of zero area", "corners that do not lie on one line");
    }
    if (!fan) {
      return complain("face", place,
                      fmt::format("a polygon of {} corners that is not convex", polygon.size()),
                      "triangles, and polygons that triangles round one of their corners cover");
    }
    const int first = static_cast<int>(mesh_.triangles.size());
    mesh_.triangles.insert(mesh_.triangles.end(), fan->begin(), fan->end());
    if (polygon.size() > 3) mesh_.fans.push_back({first, static_cast<int>(fan->size())});
  }

  void add_segment(std::size_t s) {
    const auto [a, b] = raw_.segments[s];
    const long long place = raw_.segment_place[s];
    if (!in_range("edge", a, place) || !in_range("edge", b, place)) return;
    if (a == b) return complain("edge", place, raw_.vertex_found(a) + " twice", "two different vertices");
    const auto [other, is_new] = edges_.try_emplace(std::minmax(a, b), place);
    if (!is_new) {
      return complain("edge", place, fmt::format("the same vertices as at {}", other->second),
                      "each edge once");
    }
    mesh_.segments.push_back({static_cast<int>(a), static_cast<int>(b)});
  }

  void add_tetrahedron(std::size_t t) {
    const long long place = raw_.tetrahedron_place[t];
    std::array<int, 4> corners{};
    for (std::size_t k = 0; k < 4; ++k) {
      if (!in_range("tetrahedron", raw_.tetrahedra[t][k], place)) return;
      corners[k] = static_cast<int>(raw_.tetrahedra[t][k]);
    }
    std::array<int, 4> sorted = corners;
    std::sort(sorted.begin(), sorted.end());
    const auto [other, is_new] = tetrahedra_.try_emplace(sorted, place);
    if (!is_new) {
      return complain("tetrahedron", place, fmt::format("the same corners as at {}", other->second),
                      "each tetrahedron once");
    }
    const double volume = tetrahedron_volume(mesh_.vertices, corners);
    if (std::isfinite(volume) && !(volume > flat_volume(corners))) {
      return complain("tetrahedron", place, fmt::format("a tetrahedron of {:g} m^3", volume),
                      "volume > 0: corner 3 on the side to which 0 1 2 runs counter-clockwise");
    }
    mesh_.tetrahedra.push_back(corners);
  }

  /// Volume of a tetrahedron that is flat up to the rounding of its coordinates.
  double flat_volume(const std::array<int, 4>& t) const {
    double longest = 0;
    for (std::size_t k = 1; k < 4; ++k) {
      longest = std::max(longest, (mesh_.vertices.col(t[k]) - mesh_.vertices.col(t[0])).norm());
    }
    return std::numeric_limits<double>::epsilon() * longest * longest * longest;
  }

  const RawMesh& raw_;
  TriangleMesh mesh_;
  std::map<std::vector<int>, long long> faces_;
  std::map<std::pair<long long, long long>, long long> edges_;
  std::map<std::array<int, 4>, long long> tetrahedra_;
  std::vector<Violation> violations_;
};

}  // namespace

TriangleMesh assemble_mesh(const RawMesh& raw) { return Assembler(raw).run(); }

}  // namespace bb
