#include "core/model/bodies/lumping.hpp"

#include <algorithm>

#include "core/model/mesh/topology.hpp"

namespace bb {
namespace {

/// Parts of a triangle at its corners, as fractions of its area.
std::array<double, 3> mixed_voronoi_parts(const Positions& x, const std::array<int, 3>& t, double area) {
  std::array<double, 3> dot{}, opposite_sq{};  // at corner k: of the two sides there; of the side across
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d u = x.col(t[(k + 1) % 3]) - x.col(t[k]), v = x.col(t[(k + 2) % 3]) - x.col(t[k]);
    dot[k] = u.dot(v);
    opposite_sq[k] = (v - u).squaredNorm();
  }
  for (std::size_t k = 0; k < 3; ++k) {
    if (dot[k] >= 0) continue;
    std::array<double, 3> out{0.25, 0.25, 0.25};
    out[k] = 0.5;
    return out;
  }
  std::array<double, 3> out{};
  for (std::size_t k = 0; k < 3;
       ++k) {  // cot of a corner = dot/(2 area); 1/8 of it times the sides that meet at k
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    out[k] = (opposite_sq[i] * dot[i] + opposite_sq[j] * dot[j]) / (16 * area * area);
  }
  return out;
}

void lump_uniformly(const TriangleMesh& mesh, double per_area, const AddMass& add) {
  std::vector<int> vertices;
  for (const auto& t : mesh.triangles) vertices.insert(vertices.end(), t.begin(), t.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  const double each = per_area * surface_area(mesh) / static_cast<double>(vertices.size());
  for (const int v : vertices) add(v, each);
}

}  // namespace

CornerParts load_parts(const Positions& x, const std::array<int, 3>& triangle, Lumping lumping) {
  if (lumping != Lumping::mixed_voronoi) return {1.0 / 3, 1.0 / 3, 1.0 / 3};
  return mixed_voronoi_parts(x, triangle, area_vector(x, triangle).norm());
}

void append_load_parts(const BodySpec& spec, std::span<const std::array<int, 3>> triangles,
                       std::size_t before, std::vector<CornerParts>& all) {
  const bool thirds = spec.kind == BodyKind::rigid || spec.material.lumping != Lumping::mixed_voronoi;
  if (thirds && all.empty()) return;
  all.resize(before, {1.0 / 3, 1.0 / 3, 1.0 / 3});
  for (const auto& t : triangles) {
    all.push_back(load_parts(spec.mesh.vertices, t, thirds ? Lumping::barycentric : spec.material.lumping));
  }
}

void lump_triangles(const TriangleMesh& mesh, Lumping lumping, double per_area, const AddMass& add) {
  if (mesh.triangles.empty()) return;
  if (lumping == Lumping::uniform) return lump_uniformly(mesh, per_area, add);
  for (const auto& t : mesh.triangles) {
    const double area = area_vector(mesh.vertices, t).norm(), whole = per_area * area;
    if (lumping == Lumping::barycentric) {
      for (const int v : t) add(v, whole / 3);
      continue;
    }
    const std::array<double, 3> part = mixed_voronoi_parts(mesh.vertices, t, area);
    for (std::size_t k = 0; k < 3; ++k) add(t[k], whole * part[k]);
  }
}

}  // namespace bb
