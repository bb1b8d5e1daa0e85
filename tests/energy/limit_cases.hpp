// Limited triangles in space and in the plane, and limited tetrahedra, at a state where the limit acts on some of them.
#pragma once

#include <Eigen/Eigenvalues>
#include <string>

#include "core/model/mesh/solid_generators.hpp"
#include "tests/energy/host_limit.hpp"
#include "tests/energy/strip.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::test {

struct LimitCase {
  std::string name;
  bool planar = false;
  StrainLimitPart triangles;
  SolidLimitPart tetrahedra;
  Positions rest, x;

  bool of_solids() const { return !tetrahedra.tetrahedra.empty(); }
  const StrainBands& bands() const {
    return of_solids() ? static_cast<const StrainBands&>(tetrahedra) : triangles;
  }
  /// The case outlives it.
  HostLimit make(exec::Order order = exec::Order::threads, Precision precision = Precision::full) const {
    return of_solids() ? HostLimit(tetrahedra, rest, precision, order)
                       : HostLimit(triangles, rest, planar, precision, order);
  }
  std::vector<int> vertices(std::size_t e) const {
    if (of_solids()) return {tetrahedra.tetrahedra[e].begin(), tetrahedra.tetrahedra[e].end()};
    return {triangles.triangles[e].begin(), triangles.triangles[e].end()};
  }
};

inline std::vector<LimitCase> limit_cases(double onset, double width) {
  std::vector<LimitCase> out(3);
  const Strip strip(50);
  for (const bool planar : {false, true}) {
    LimitCase& sheet = out[planar ? 1 : 0];
    sheet.name = planar ? "triangles in the plane" : "triangles";
    sheet.planar = planar;
    sheet.triangles = limited(strip.triangles, onset, width);
    sheet.rest = strip.rest, sheet.x = strip.deformed;
  }
  LimitCase& block = out[2];
  const TriangleMesh mesh = solid_box_mesh({3, 2, 2}, Vec3d(0.6, 0.4, 0.4));
  block.name = "tetrahedra";
  block.tetrahedra = limited(mesh.tetrahedra, onset, width);
  block.rest = block.x = mesh.vertices;
  for (Eigen::Index i = 0; i < block.x.size(); ++i)
    block.x.data()[i] *= 1 + 0.2 * std::sin(static_cast<double>(i));
  return out;
}

/// Stretches of an element, descending: roots of the eigenvalues of its two Gram matrices of edges. Nothing of the code under test.
inline std::vector<Long> stretches_of(const LimitCase& of, std::size_t e) {
  using Matrix = Eigen::Matrix<Long, Eigen::Dynamic, Eigen::Dynamic>;
  const std::vector<int> corners = of.vertices(e);
  const auto gram = [&](const Positions& x) -> Matrix {
    Matrix edges(3, static_cast<Eigen::Index>(corners.size()) - 1);
    for (std::size_t k = 1; k < corners.size(); ++k) {
      edges.col(static_cast<Eigen::Index>(k) - 1) = (x.col(corners[k]) - x.col(corners[0])).cast<Long>();
    }
    if (of.planar) edges.row(2).setZero();
    return edges.transpose() * edges;
  };
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> found(gram(of.x), gram(of.rest));
  std::vector<Long> out;
  for (Eigen::Index k = found.eigenvalues().size() - 1; k >= 0; --k)
    out.push_back(std::sqrt(found.eigenvalues()[k]));
  return out;
}

}  // namespace bb::test
