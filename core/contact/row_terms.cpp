// Gradients and Hessians of the rows without mollifier, four Hessians at a time.
#include <algorithm>
#include <array>

#include "core/contact/chunks.hpp"
#include "core/contact/contact_terms.hpp"
#include "core/contact/gap_along.hpp"
#include "core/contact/numeric_projection.hpp"
#include "core/contact/pair_lanes.hpp"
#include "core/contact/pair_row.hpp"
#include "core/contact/row_columns.hpp"
#include "core/contact/row_hessian.hpp"
#include "core/contact/sliding_shape.hpp"

namespace bb {
namespace {

template <class T>
T scale_of(const ContactTable& rows, std::size_t r) {
  return entry<T>(rows.kappa, r);
}

template <class T>
Vec<T, 3> normal_of(const ContactTable& rows, std::size_t r) {
  return Vec3d::Map(&rows.normal[3 * r]).cast<T>();
}

/// grad d on the compact slots.
template <class T>
Vec<T, 12> gap_gradient(const ContactTable& rows, std::size_t r) {
  Vec<T, 12> g = Vec<T, 12>::Zero();
  const Vec<T, 3> normal = normal_of<T>(rows, r);
  for (int k = 0; k < rows.n_free[r]; ++k) {
    g.template segment<3>(3 * k) = entry<T>(rows.weight, 4 * r + static_cast<std::size_t>(k)) * normal;
  }
  return g;
}

/// stiffness grad d grad d^T.
template <class T>
void store_stiffness(const Vec<T, 12>& grad_d, T stiffness, double* hess) {
  for (int b = 0; b < 4; ++b) {
    for (int a = b; a < 4; ++a) {
      for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) *hess++ = stiffness * (grad_d[3 * a + r] * grad_d[3 * b + c]);
      }
    }
  }
}

/// Rows whose closest points slide nowhere: grad^2 d = w w^T x curvature (I - n n^T - flat flat^T), and both
/// of its parts are eigenspaces.
template <class T>
void store_fixed_points(const ContactTable& rows, std::size_t r, Projection projection, double* hess) {
  const bool obstacle = is_obstacle(rows.kind[r]);
  const T scale = scale_of<T>(rows, r);
  const T curvature =
      obstacle ? entry<T>(rows.curvature, r) : 1 / (entry<T>(rows.d, r) + entry<T>(rows.offset, r));
  const Vec<T, 3> n = normal_of<T>(rows, r);
  Vec<T, 3> flat = Vec<T, 3>::Zero();
  if (obstacle) flat = Vec3d::Map(&rows.flat[3 * r]).template cast<T>();
  const Mat<T, 3, 3> unit = fixed_points_block<T>(n, flat, scale * entry<T>(rows.d2b, r),
                                                  scale * entry<T>(rows.db, r) * curvature, projection);
  for (std::size_t j = 0; j < 4; ++j) {
    for (std::size_t i = j; i < 4; ++i, hess += 9) {
      const Mat<T, 3, 3> block = (entry<T>(rows.weight, 4 * r + i) * entry<T>(rows.weight, 4 * r + j)) * unit;
      Mat3d::Map(hess) = block.template cast<double>();
    }
  }
}

/// The vertices of a row that are free, a bit each, in role order.
unsigned free_of(const ContactTable& rows, std::size_t r) {
  unsigned free = 0;
  std::size_t slot = 0;
  for (std::size_t k = 0; k < 4 && slot < static_cast<std::size_t>(rows.n_free[r]); ++k) {
    if (rows.stencil[4 * r + k] != rows.vertex[4 * r + slot]) continue;
    free |= 1u << k;
    ++slot;
  }
  return free;
}

template <class T>
struct RowPoints {
  const int* vertex;
  const PositionsView& x;
  template <int N>
  Mat<T, 3, N> first() const {
    std::array<int, N> of;
    std::copy_n(vertex, N, of.begin());
    return gather_in<T>(x, of);
  }
};

/// The local frame of a row on the compact slots; the closest points are those that the row keeps.
template <int F, class T>
RowShape<T, F> row_shape(const ContactTable& rows, std::size_t r, const PositionsView& x) {
  const SlidingRow<T> row{rows.kind[r],
                          free_of(rows, r),
                          Vec<double, 4>::Map(&rows.stencil_weight[4 * r]).template cast<T>(),
                          normal_of<T>(rows, r),
                          entry<T>(rows.d, r) + entry<T>(rows.offset, r),
                          scale_of<T>(rows, r) * entry<T>(rows.d2b, r),
                          scale_of<T>(rows, r) * entry<T>(rows.db, r)};
  RowShape<T, F> out;
  with_sliding_shape<T>(row, RowPoints<T>{&rows.stencil[4 * r], x},
                        Vec<T, 3>(Vec3d::Map(&rows.flat[3 * r]).template cast<T>()), [&](const auto& shape) {
                          if constexpr (std::is_same_v<std::decay_t<decltype(shape)>, RowShape<T, F>>)
                            out = shape;
                        });
  move_to_front(row.free, out);
  return out;
}

template <class T>
using FourOf = Lanes<T, static_cast<int>(n_lanes)>;

template <int F, class T>
void set_lane(RowShape<FourOf<T>, F>& lanes, std::size_t lane, const RowShape<T, F>& row) {
  const auto set = [lane](auto& to, const auto& from) {
    for (Eigen::Index k = 0; k < from.size(); ++k) to[k].v[lane] = from[k];
  };
  set(lanes.w, row.w);
  set(lanes.n, row.n);
  for (int l = 0; l < F; ++l) {
    set(lanes.g[l], row.g[l]);
    set(lanes.q[l], row.q[l]);
  }
  lanes.distance.v[lane] = row.distance;
  lanes.stiffness.v[lane] = row.stiffness;
  lanes.force.v[lane] = row.force;
  lanes.bend.v[lane] = row.bend;
}

/// Rows of one number of sliding edges, four Hessians at a time; what is missing to four is made up by the
/// first of them.
template <int F, class T>
void store_sliding(const ContactTable& rows, const std::size_t* list, std::size_t n, const PositionsView& x,
                   Projection projection, double* hess) {
  RowShape<FourOf<T>, F> shape;
  FourOf<T> blocks[row_hessian_numbers];
  for (std::size_t begin = 0; begin < n; begin += n_lanes) {
    const std::size_t used = std::min(n_lanes, n - begin);
    for (std::size_t lane = 0; lane < n_lanes; ++lane) {
      set_lane<F, T>(shape, lane, row_shape<F, T>(rows, list[begin + (lane < used ? lane : 0)], x));
    }
    row_hessian<FourOf<T>, F>(shape, projection, blocks);
    for (std::size_t lane = 0; lane < used; ++lane) {
      double* const out = hess + row_hessian_numbers * list[begin + lane];
      for (std::size_t k = 0; k < row_hessian_numbers; ++k) out[k] = blocks[k].v[lane];
    }
  }
}

/// The rows [begin, end), at most a chunk of them.
template <class T>
void store_rows(const ContactTable& rows, std::size_t begin, std::size_t end, const PositionsView& x,
                HessianMode mode, Projection projection, PassParts parts, double* grad, double* hess) {
  std::array<std::size_t, chunk_size> sliding[2];
  std::size_t n[2] = {0, 0};
  for (std::size_t r = begin; r < end; ++r) {
    const Vec<T, 12> grad_d = gap_gradient<T>(rows, r);
    if (parts.values) {
      const Vec<T, 12> g = (scale_of<T>(rows, r) * entry<T>(rows.db, r)) * grad_d;
      Vec<double, 12>::Map(grad + 12 * r) = g.template cast<double>();
    }
    if (!parts.hessians) continue;
    const int edges = n_sliding(rows.kind[r]);
    if (mode == HessianMode::gauss_newton || rows.db[r] == 0) {
      store_stiffness<T>(grad_d, scale_of<T>(rows, r) * entry<T>(rows.d2b, r),
                         hess + row_hessian_numbers * r);
    } else if (edges == 0) {
      store_fixed_points<T>(rows, r, projection, hess + row_hessian_numbers * r);
    } else {
      sliding[edges - 1][n[edges - 1]++] = r;
    }
  }
  store_sliding<1, T>(rows, sliding[0].data(), n[0], x, projection, hess);
  store_sliding<2, T>(rows, sliding[1].data(), n[1], x, projection, hess);
}

/// dx on the compact slots.
Mat<double, 3, 4> motion_of(const ContactTable& rows, std::size_t r, const PositionsView& dx) {
  Mat<double, 3, 4> out = Mat<double, 3, 4>::Zero();
  for (int k = 0; k < rows.n_free[r]; ++k) {
    out.col(k) = dx.col(rows.vertex[4 * r + static_cast<std::size_t>(k)]);
  }
  return out;
}

GapAlong gap_along(const ContactTable& rows, std::size_t r, const PositionsView& x, const PositionsView& dx) {
  const Mat<double, 3, 4> moved = motion_of(rows, r, dx);
  const int edges = n_sliding(rows.kind[r]);
  if (edges == 1) return bb::gap_along(row_shape<1, double>(rows, r, x), moved);
  if (edges == 2) return bb::gap_along(row_shape<2, double>(rows, r, x), moved);
  const double curvature = is_obstacle(rows.kind[r]) ? rows.curvature[r] : 1 / (rows.d[r] + rows.offset[r]);
  return bb::gap_along(normal_of<double>(rows, r), Vec3d::Map(&rows.flat[3 * r]), curvature,
                       moved * Vec<double, 4>::Map(&rows.weight[4 * r]));
}

}  // namespace

HoldTimes add_curvature_correction(const ContactTable& rows, const PositionsView& x, const PositionsView& dx,
                                   PositionsSpan force) {
  HoldTimes held;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows.n_free[r] == 0) continue;
    const GapAlong gap = gap_along(rows, r, x, dx);
    held.add(rows.d[r], gap);
    const double missed = scale_of<double>(rows, r) * rows.d2b[r] * gap.missing(rows.d[r]);
    if (!(missed > 0)) continue;
    for (std::size_t k = 0; k < 4 && rows.vertex[4 * r + k] >= 0; ++k) {
      force.col(rows.vertex[4 * r + k]) += missed * rows.weight[4 * r + k] * normal_of<double>(rows, r);
    }
  }
  return held;
}

void contact_terms(const ContactTable& rows, const PositionsView& x, HessianMode mode, Projection projection,
                   std::vector<double>& grad, std::vector<double>& hess, Precision precision) {
  grad.resize(12 * rows.size());
  hess.resize(row_hessian_numbers * rows.size());
  const bool numeric = is_numeric(mode) && projection != Projection::none;
  const Projection analytic = numeric ? Projection::none : projection;
  for_each_pass(precision, [&]<class T>(PassParts parts) {
    for_each_chunk(rows.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
      store_rows<T>(rows, begin, end, x, mode, analytic, parts, grad.data(), hess.data());
      if (!numeric || !parts.hessians) return;
      project_numerically(mode, projection, end - begin, hess.data() + row_hessian_numbers * begin);
    });
  });
}

}  // namespace bb
