// What makes room for gaps that are curved along a motion: add_detour() of core/contact/contact_terms.hpp row by row.
#pragma once

#include "core/contact/gap_along.hpp"
#include "core/exec/sums/sum_kernels.hpp"
#include "core/resident/contact/term_kernels.hpp"

namespace bb::resident {

/// Puts stretch times what the gap of the row misses in the place of push, and 0 in those of energy and stretch; all three
/// are 0 in mollified rows. So gathering pushes is the force. Keys: smallest_key() of HoldTimes.
struct DetourRows {
  RowView rows;
  SurfaceView surface;
  const double *x, *dx;  // [3 n_vertices]
  Key *curved, *straight;

  BB_HD void operator()(Index r) const {
    double push = 0;
    if (!rows.mollified(r) && rows.n_free(r) > 0) {
      const GapAlong gap = along(r);
      const double d = rows.d[r];
      exec::atomic_min(gap.curved(d) ? curved : straight, smallest_key(gap.half_time(d)));
      push = rows.stretch[r] * gap.missing(d);
    }
    rows.energy[r] = rows.stretch[r] = 0;
    rows.push[r] = push > 0 ? push : 0;
  }

 private:
  BB_HD GapAlong along(Index r) const {
    Mat<double, 3, 4> moved = Mat<double, 3, 4>::Zero();
    for (int k = 0; k < 4; ++k) {
      if (!rows.is_free(r, k)) continue;
      const Index vertex = rows.vertex[k * rows.n + r];
      for (int c = 0; c < 3; ++c) moved(c, k) = dx[3 * vertex + c];
    }
    switch (static_cast<ContactKind>(rows.kind[r])) {
      case ContactKind::point_edge:
        return gap_along(sliding_shape<PairKind::point_edge>(rows, surface, r, x), moved);
      case ContactKind::point_triangle:
        return gap_along(sliding_shape<PairKind::point_triangle>(rows, surface, r, x), moved);
      case ContactKind::edge_edge:
        return gap_along(sliding_shape<PairKind::edge_edge>(rows, surface, r, x), moved);
      case ContactKind::obstacle_edge:
        return gap_along(obstacle_row_shape<2>(rows, surface, r, x), moved);
      case ContactKind::obstacle_triangle:
        return gap_along(obstacle_row_shape<3>(rows, surface, r, x), moved);
      default:
        return at_fixed_points(r, moved);
    }
  }
  BB_HD GapAlong at_fixed_points(Index r, const Mat<double, 3, 4>& moved) const {
    const RowCurvature at = row_curvature(rows, surface, r, x);
    return gap_along(rows.normal_of(r), at.flat, at.curvature, moved * weights_of(rows, r));
  }
};

}  // namespace bb::resident
