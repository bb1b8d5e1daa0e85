// Scenes of a few triangles for the tests of the audit.
#pragma once

#include "core/audit/audit.hpp"

namespace bb::audit {

inline constexpr double tolerance = 1e-9;

inline AuditMesh surface(const Eigen::Matrix3Xi& triangles) {
  AuditMesh mesh;
  mesh.triangles = triangles;
  mesh.edges.resize(2, 3 * triangles.cols());  // shared edges twice: harmless
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) mesh.edges.col(3 * t + k) << triangles(k, t), triangles((k + 1) % 3, t);
  }
  return mesh;
}

/// Vertices 0..2 and 3..5: two triangles that share nothing.
inline AuditMesh two_triangles() {
  Eigen::Matrix3Xi t(3, 2);
  t << 0, 3,  //
      1, 4,   //
      2, 5;
  return surface(t);
}

/// Vertices 0..3: a square sheet of two triangles, the first at z = 0, the second rising to 0.2; 4..6: a
/// small triangle above the first.
inline AuditMesh sheet_and_triangle() {
  Eigen::Matrix3Xi t(3, 3);
  t << 0, 0, 4,  //
      1, 2, 5,   //
      2, 3, 6;
  return surface(t);
}

inline Positions sheet_and_triangle_at(double z) {
  Positions x(3, 7);
  x << -1, 1, 1, -1, 0.3, 0.5, 0.4,     //
      -1, -1, 1, 1, -0.5, -0.45, -0.2,  //
      0, 0, 0, 0.2, z, z + 0.01, z - 0.01;
  return x;
}

}  // namespace bb::audit
