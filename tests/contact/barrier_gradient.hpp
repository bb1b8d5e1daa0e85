// Gradient and Hessian of B of all rows at a state, dense, for the tests that compare them with B itself.
#pragma once

#include "core/math/lower_blocks.hpp"
#include "tests/contact/contact_scenes.hpp"
#include "tests/oracle/lower_blocks.hpp"

namespace bb::test {

/// Gradient [3 n_vertices] of B of rows at x whose barriers are evaluated, and with a place for it its unprojected Hessian.
inline VecXd gradient_of(const Rows& rows, const Positions& x, Eigen::MatrixXd* hessian = nullptr) {
  VecXd out = VecXd::Zero(x.size());
  std::vector<double> grad, hess;
  const auto scatter = [&](const std::vector<int>& vertex, std::size_t n) {
    for (std::size_t r = 0; r < n; ++r) {
      const Eigen::MatrixXd h = from_lower_blocks(&hess[n_lower_numbers(4) * r], 4);
      for (int i = 0; i < 4; ++i) {
        const int vi = vertex[4 * r + at(i)];
        if (vi < 0) continue;
        out.segment<3>(3 * vi) += Vec3d::Map(&grad[12 * r + 3 * at(i)]);
        for (int j = 0; j < 4 && hessian; ++j) {
          const int vj = vertex[4 * r + at(j)];
          if (vj >= 0) hessian->block<3, 3>(3 * vi, 3 * vj) += h.block<3, 3>(3 * i, 3 * j);
        }
      }
    }
  };
  contact_terms(rows.table, x, HessianMode::projected_full, Projection::none, grad, hess);
  scatter(rows.table.vertex, rows.table.size());
  mollified_terms(rows.mollified, x, Projection::none, grad, hess);
  scatter(rows.mollified.free_vertex, rows.mollified.size());
  return out;
}

/// The same of the rows at x with the cubic shape of the tests.
inline VecXd gradient_of(ContactSystem& contacts, const Positions& x, Eigen::MatrixXd* hessian = nullptr) {
  Rows rows = rows_at(contacts, x);
  evaluate(rows.table, 3.5, TestShape::cubic);
  evaluate(rows.mollified, 3.5, TestShape::cubic);
  return gradient_of(rows, x, hessian);
}

}  // namespace bb::test
