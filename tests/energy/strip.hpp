// A strip of triangles with its edges and hinges, at rest (flat) and deformed: the mesh of the tests of families.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "core/math/types.hpp"

namespace bb::test {

struct Strip {
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::array<int, 2>> edges;
  std::vector<std::array<int, 4>> hinges;  // e0 e1 v0 v1
  Positions rest, deformed;

  /// 2 n triangles over 2 (n + 1) vertices; vertex 2i below, 2i + 1 above.
  explicit Strip(int n) : rest(3, 2 * (n + 1)), deformed(3, 2 * (n + 1)) {
    for (int i = 0; i <= n; ++i) {
      for (int row = 0; row < 2; ++row) {
        const double x = 0.1 * i, y = 0.12 * row + 0.01 * (i % 3);
        rest.col(2 * i + row) = Vec3d(x, y, 0);
        deformed.col(2 * i + row) =
            Vec3d(1.1 * x + 0.01 * std::sin(3.0 * i), 0.9 * y, 0.02 * std::cos(2.0 * i + row));
      }
    }
    for (int i = 0; i < n; ++i) {
      const int a = 2 * i, b = a + 1, c = a + 2, d = a + 3;
      triangles.push_back({a, c, b});
      triangles.push_back({c, d, b});
      edges.push_back({a, c});
      hinges.push_back({c, b, d, a});
      if (i > 0) hinges.push_back({b, a, a - 2, c});
    }
  }
};

}  // namespace bb::test
