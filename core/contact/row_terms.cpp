// Gradients and Hessians of the rows without mollifier, four Hessians at a time.
#include <algorithm>
#include <array>

#include "core/contact/chunks.hpp"
#include "core/contact/contact_row.hpp"
#include "core/contact/contact_terms.hpp"
#include "core/contact/pair_lanes.hpp"
#include "core/contact/row_hessian.hpp"
#include "core/geometry/distance_derivatives.hpp"

namespace bb {
namespace {

constexpr std::size_t stored = n_lower_numbers(4);  // a row

/// Edges along which the closest points of a row slide.
constexpr int n_sliding(ContactKind kind) {
  if (kind == ContactKind::point_edge) return 1;
  return kind == ContactKind::point_triangle || kind == ContactKind::edge_edge ? 2 : 0;
}

double scale_of(const ContactTable& rows, std::size_t r) { return rows.multiplicity[r] * rows.kappa[r]; }

/// grad d on the compact slots, and the row's gradient.
Vec<double, 12> row_gradient(const ContactTable& rows, std::size_t r, double* grad) {
  Vec<double, 12> g = Vec<double, 12>::Zero();
  for (int k = 0; k < rows.n_free[r]; ++k) {
    g.segment<3>(3 * k) = rows.weight[4 * r + static_cast<std::size_t>(k)] * Vec3d::Map(&rows.normal[3 * r]);
  }
  Vec<double, 12>::Map(grad) = (scale_of(rows, r) * rows.db[r]) * g;
  return g;
}

/// stretch grad d grad d^T.
void store_stretch(const Vec<double, 12>& grad_d, double stretch, double* hess) {
  for (int b = 0; b < 4; ++b) {
    for (int a = b; a < 4; ++a) {
      for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) *hess++ = stretch * (grad_d[3 * a + r] * grad_d[3 * b + c]);
      }
    }
  }
}

/// Rows whose closest points slide nowhere: grad^2 d = w w^T x curvature (I - n n^T - flat flat^T), and both
/// of its parts are eigenspaces.
void store_fixed_points(const ContactTable& rows, std::size_t r, Projection projection, double* hess) {
  const bool obstacle = rows.kind[r] == ContactKind::obstacle;
  const double scale = scale_of(rows, r);
  const double curvature = obstacle ? rows.curvature[r] : 1 / (rows.d[r] + rows.offset[r]);
  const Vec3d n = Vec3d::Map(&rows.normal[3 * r]);
  Vec3d flat = Vec3d::Zero();
  if (obstacle) flat = Vec3d::Map(&rows.flat[3 * r]);
  const double along = project_eigenvalue(scale * rows.d2b[r], projection);
  const double across = project_eigenvalue(scale * rows.db[r] * curvature, projection);
  const Mat3d unit =
      along * n * n.transpose() + across * (Mat3d::Identity() - n * n.transpose() - flat * flat.transpose());
  for (std::size_t j = 0; j < 4; ++j) {
    for (std::size_t i = j; i < 4; ++i, hess += 9) {
      Mat3d::Map(hess) = (rows.weight[4 * r + i] * rows.weight[4 * r + j]) * unit;
    }
  }
}

/// The local frame of a row; the closest points are those that the row keeps.
template <PairKind K>
RowShape<double, n_sliding(contact_kind<K>())> row_shape(const ContactTable& rows, std::size_t r,
                                                         const Positions& x, Region interior) {
  constexpr int n = pair_points(K), F = n_sliding(contact_kind<K>());
  std::array<int, n> vertex;
  Closest<double, n> closest;
  for (int k = 0; k < n; ++k) {
    vertex[static_cast<std::size_t>(k)] = rows.stencil[4 * r + static_cast<std::size_t>(k)];
    closest.weights[k] = rows.stencil_weight[4 * r + static_cast<std::size_t>(k)];
  }
  closest.d = rows.d[r] + rows.offset[r];
  closest.r = closest.d * Vec3d::Map(&rows.normal[3 * r]);
  closest.region = interior;
  const auto frame = detail::region_frame<double, n>(gather(x, vertex), closest);
  RowShape<double, F> out;
  out.w = Vec<double, 4>::Map(&rows.weight[4 * r]);
  out.n = frame.n;
  for (int l = 0; l < F; ++l) {
    out.q[l] = frame.q[l];
    out.g[l].setZero();
    int slot = 0;
    for (int k = 0; k < n && slot < rows.n_free[r]; ++k) {
      const int free_vertex = rows.vertex[4 * r + static_cast<std::size_t>(slot)];
      if (vertex[static_cast<std::size_t>(k)] == free_vertex) out.g[l][slot++] = frame.g[l][k];
    }
  }
  out.distance = closest.d;
  out.stretch = scale_of(rows, r) * rows.d2b[r];
  out.push = scale_of(rows, r) * rows.db[r];
  return out;
}

template <int F>
RowShape<double, F> row_shape(const ContactTable& rows, std::size_t r, const Positions& x) {
  if constexpr (F == 1) {
    return row_shape<PairKind::point_edge>(rows, r, x, Region::p_e);
  } else if (rows.kind[r] == ContactKind::point_triangle) {
    return row_shape<PairKind::point_triangle>(rows, r, x, Region::p_t);
  } else {
    return row_shape<PairKind::edge_edge>(rows, r, x, Region::ea_eb);
  }
}

template <int F>
void set_lane(RowShape<Lanes4, F>& lanes, std::size_t lane, const RowShape<double, F>& row) {
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
  lanes.stretch.v[lane] = row.stretch;
  lanes.push.v[lane] = row.push;
}

/// Rows of one number of sliding edges, four Hessians at a time; what is missing to four is made up by the
/// first of them.
template <int F>
void store_sliding(const ContactTable& rows, const std::size_t* list, std::size_t n, const Positions& x,
                   Projection projection, double* hess) {
  RowShape<Lanes4, F> shape;
  Lanes4 blocks[stored];
  for (std::size_t begin = 0; begin < n; begin += n_lanes) {
    const std::size_t used = std::min(n_lanes, n - begin);
    for (std::size_t lane = 0; lane < n_lanes; ++lane) {
      set_lane<F>(shape, lane, row_shape<F>(rows, list[begin + (lane < used ? lane : 0)], x));
    }
    row_hessian<Lanes4, F>(shape, projection, blocks);
    for (std::size_t lane = 0; lane < used; ++lane) {
      double* const out = hess + stored * list[begin + lane];
      for (std::size_t k = 0; k < stored; ++k) out[k] = blocks[k].v[lane];
    }
  }
}

}  // namespace

void contact_terms(const ContactTable& rows, const Positions& x, HessianMode mode, Projection projection,
                   std::vector<double>& grad, std::vector<double>& hess) {
  grad.resize(12 * rows.size());
  hess.resize(stored * rows.size());
  for_each_chunk(rows.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
    std::array<std::size_t, chunk_size> sliding[2];
    std::size_t n[2] = {0, 0};
    for (std::size_t r = begin; r < end; ++r) {
      const Vec<double, 12> grad_d = row_gradient(rows, r, &grad[12 * r]);
      const int edges = n_sliding(rows.kind[r]);
      if (mode == HessianMode::gauss_newton || rows.db[r] == 0) {
        store_stretch(grad_d, scale_of(rows, r) * rows.d2b[r], &hess[stored * r]);
      } else if (edges == 0) {
        store_fixed_points(rows, r, projection, &hess[stored * r]);
      } else {
        sliding[edges - 1][n[edges - 1]++] = r;
      }
    }
    store_sliding<1>(rows, sliding[0].data(), n[0], x, projection, hess.data());
    store_sliding<2>(rows, sliding[1].data(), n[1], x, projection, hess.data());
  });
}

}  // namespace bb
