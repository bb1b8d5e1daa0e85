#include "core/energy/rest_shapes.hpp"

#include <string>

#include "core/math/error.hpp"

namespace bb {

std::vector<TriangleRest<double>> triangle_rests(std::span<const std::array<int, 3>> triangles,
                                                 const PositionsView& x_rest, bool planar,
                                                 std::span<const Vec3d> warp) {
  std::vector<TriangleRest<double>> rests;
  rests.reserve(triangles.size());
  if (!warp.empty() && warp.size() != triangles.size()) {
    throw ConfigError("membrane/warp", std::to_string(warp.size()) + " directions",
                      std::to_string(triangles.size()) + ", one a triangle");
  }
  for (const auto& [a, b, c] : triangles) {
    const Vec3d x[3] = {x_rest.col(a), x_rest.col(b), x_rest.col(c)};
    const Vec3d u = warp.empty() ? Vec3d(x[1] - x[0]) : warp[rests.size()];
    rests.push_back(planar ? planar_triangle_rest<double>(x, u) : triangle_rest<double>(x, u));
    if (!(rests.back().area > 0 && rests.back().dm_inv.allFinite())) {
      throw ConfigError("triangle " + std::to_string(rests.size() - 1),
                        "no area, or no warp direction in its plane", "a rest triangle of area > 0");
    }
  }
  return rests;
}

std::vector<TetrahedronRest<double>> tetrahedron_rests(std::span<const std::array<int, 4>> tetrahedra,
                                                       const PositionsView& x_rest) {
  std::vector<TetrahedronRest<double>> rests;
  for (const auto& t : tetrahedra) {
    const Vec3d x[4] = {x_rest.col(t[0]), x_rest.col(t[1]), x_rest.col(t[2]), x_rest.col(t[3])};
    rests.push_back(tetrahedron_rest<double>(x));
    if (!(rests.back().volume > 0 && rests.back().dm_inv.allFinite())) {
      throw ConfigError("tetrahedron " + std::to_string(rests.size() - 1),
                        std::to_string(rests.back().volume) + " m^3", "a rest tetrahedron of volume > 0");
    }
  }
  return rests;
}

}  // namespace bb
