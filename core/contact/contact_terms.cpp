
#include <algorithm>

#include "core/contact/contact_terms.hpp"
#include "core/contact/edge_end_row.hpp"
#include "core/contact/mollified_terms.hpp"
#include "core/contact/obstacle_pair.hpp"
#include "core/contact/pair_geometry.hpp"
#include "core/contact/row_columns.hpp"
#include "core/contact/sliding_shape.hpp"
#include "core/math/lower_blocks.hpp"
#include "core/math/parallel.hpp"

namespace bb {

namespace {

template <class T>
using Hessian12 = Mat<T, 12, 12>;
/// The vertices of a row that are free, a bit each.
unsigned free_of(const MollifiedTable& rows, std::size_t r) {
  unsigned free = 0;
  for (unsigned k = 0; k < 4; ++k) free |= (rows.vertex[4 * r + k] >= 0 ? 1u : 0u) << k;
  return free;
}

template <class T>
Vec<T, 3> axis_of(const MollifiedTable& rows, std::size_t r) {
  return Vec3d::Map(&rows.axis[3 * r]).cast<T>();
}

/// Points across the axis of a row of an edge and an axis.
template <class T>
Mat<T, 3, 3> points_across_axis(const MollifiedTable& rows, std::size_t r, const PositionsView& x) {
  const AnalyticSurface<T> line{ObstacleKind::cylinder, Vec3d::Map(&rows.axis_point[3 * r]).cast<T>(),
                                axis_of<T>(rows, r), T(0), false};
  return about_centre<2, T>(line, gather_in<T>(x, std::array{rows.stencil[4 * r], rows.stencil[4 * r + 1]}));
}

template <class T>
Mat<T, 3, 4> mollified_points(const MollifiedTable& rows, std::size_t r, const PositionsView& x) {
  return gather_in<T>(x, std::array{rows.stencil[4 * r], rows.stencil[4 * r + 1], rows.stencil[4 * r + 2],
                                    rows.stencil[4 * r + 3]});
}

template <class T>
T mollifier_value(const MollifiedTable& rows, std::size_t r, const PositionsView& x) {
  const T eps = entry<T>(rows.eps, r);
  return rows.of_axis(r) ? edge_axis_mollifier_value<T>(points_across_axis<T>(rows, r, x), eps)
                         : edge_edge_mollifier_value<T>(mollified_points<T>(rows, r, x), eps);
}

/// Of e(x) b(d(x)), e that of two edges and d that of one of their ends and the edge that it does not belong to.
template <class T>
MollifiedDerivatives<T> end_derivatives(const Mat<T, 3, 4>& points, int end, T eps, T b, T db, T d2b) {
  const auto e = edge_edge_mollifier<T>(points, eps);
  const auto d = distance_derivatives<T, 4>(points, closest_at_end<T>(points, end));
  const Hessian12<T> cross = db * e.gradient * d.gradient.transpose();
  MollifiedDerivatives<T> out;
  out.gradient = b * e.gradient + (db * e.value) * d.gradient;
  out.hessian = cross + cross.transpose() + b * e.hessian + (db * e.value) * d.hessian;
  out.hessian += (d2b * e.value) * d.gradient * d.gradient.transpose();
  return out;
}

/// Of kappa e(x) b(d(x)) in all four points, as they stand in the stencil.
template <class T>
MollifiedDerivatives<T> mollified_derivatives(const MollifiedTable& rows, std::size_t r,
                                              const PositionsView& x) {
  const T scale = entry<T>(rows.kappa, r), eps = entry<T>(rows.eps, r);
  const T b = scale * entry<T>(rows.b, r), db = scale * entry<T>(rows.db, r),
          d2b = scale * entry<T>(rows.d2b, r);
  if (rows.of_axis(r)) {
    return bb::mollified_derivatives<T>(points_across_axis<T>(rows, r, x), axis_of<T>(rows, r), eps, b, db,
                                        d2b);
  }
  const Mat<T, 3, 4> points = mollified_points<T>(rows, r, x);
  const int end = pair_end(rows.pair[r]);
  return end < 0 ? bb::mollified_derivatives<T>(points, eps, b, db, d2b)
                 : end_derivatives<T>(points, end, eps, b, db, d2b);
}

/// grad and hess on the compact free slots.
template <class T>
void mollified_row_terms(const MollifiedTable& rows, std::size_t r, const PositionsView& x,
                         Projection projection, PassParts parts, double* grad, double* hess) {
  const auto [g, full] = mollified_derivatives<T>(rows, r, x);
  if (parts.hessians) {
    Hessian12<T> h = moved_to_front<T>(free_of(rows, r), full);
    project_leading<T>(rows.n_free[r], projection, h);
    store_lower_blocks(4, h, hess, [](T entry) -> double { return entry; });
  }
  if (!parts.values) return;
  Vec<double, 12>::Map(grad).setZero();
  int slot = 0;
  for (int k = 0; k < 4; ++k) {
    if (rows.vertex[4 * r + static_cast<std::size_t>(k)] < 0) continue;
    Vec3d::Map(grad + 3 * slot++) = g.template segment<3>(3 * k).template cast<double>();
  }
}

}  // namespace

void mollified_terms(const MollifiedTable& rows, const PositionsView& x, Projection projection,
                     std::vector<double>& grad, std::vector<double>& hess, Precision precision) {
  grad.resize(12 * rows.size());
  hess.resize(row_hessian_numbers * rows.size());
  for_each_pass(precision, [&]<class T>(PassParts parts) {
    parallel_items(rows.size(), 1, [&](std::size_t r) {
      mollified_row_terms<T>(rows, r, x, projection, parts, &grad[12 * r], &hess[row_hessian_numbers * r]);
    });
  });
}

void add_given_motion(const ContactTable& rows, const PositionsView& motion, PositionsSpan force) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Eigen::Map<const Vec3d> normal(&rows.normal[3 * r]);
    double closing = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const int vertex = rows.stencil[4 * r + k];
      if (vertex >= 0) closing += rows.stencil_weight[4 * r + k] * normal.dot(motion.col(vertex));
    }
    if (closing == 0) continue;
    const double stiffness = rows.stiffness(r);
    for (std::size_t k = 0; k < 4 && rows.vertex[4 * r + k] >= 0; ++k) {
      force.col(rows.vertex[4 * r + k]) += (stiffness * closing * rows.weight[4 * r + k]) * normal;
    }
  }
}

void add_given_motion(const MollifiedTable& rows, const PositionsView& x, const PositionsView& motion,
                      PositionsSpan force) {
  for (std::size_t r = 0; r < rows.size(); ++r) {
    Vec<double, 12> moved = Vec<double, 12>::Zero();
    const int obstacle = rows.of_axis(r) ? rows.stencil[4 * r + 2] : -1;
    for (int k = 0; k < (rows.of_axis(r) ? 2 : 4); ++k) {
      moved.segment<3>(3 * k) = motion.col(rows.stencil[4 * r + static_cast<std::size_t>(k)]);
      if (obstacle >= 0) moved.segment<3>(3 * k) -= motion.col(obstacle);
    }
    if (moved.isZero(0)) continue;
    const Vec<double, 12> change = mollified_derivatives<double>(rows, r, x).hessian * moved;
    for (int k = 0; k < 4; ++k) {
      const int vertex = rows.vertex[4 * r + static_cast<std::size_t>(k)];
      if (vertex >= 0) force.col(vertex) += change.segment<3>(3 * k);
    }
  }
}

void contact_energies(const ContactTable& rows, std::vector<double>& energy, Precision precision) {
  energy.resize(rows.size());
  with_value_scalar(precision, [&]<class T>() {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      energy[r] = entry<T>(rows.kappa, r) * entry<T>(rows.b, r);
    }
  });
}

double mollifier_of(const MollifiedTable& rows, std::size_t r, const PositionsView& x) {
  return mollifier_value<double>(rows, r, x);
}

Vec<double, 12> mollified_gradient(const MollifiedTable& rows, std::size_t r, const PositionsView& x) {
  return mollified_derivatives<double>(rows, r, x).gradient;
}

void mollified_energies(const MollifiedTable& rows, const PositionsView& x, std::vector<double>& energy,
                        Precision precision) {
  energy.resize(rows.size());
  with_value_scalar(precision, [&]<class T>() {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      const T e = mollifier_value<T>(rows, r, x);
      energy[r] = entry<T>(rows.kappa, r) * e * entry<T>(rows.b, r);
    }
  });
}

}  // namespace bb
