// The curvature correction for gaps that are curved along a motion: add_curvature_correction() of core/contact/contact_terms.hpp row by row.
#pragma once

#include "core/contact/executor/term_kernels.hpp"
#include "core/contact/gap_along.hpp"
#include "core/exec/sums/sum_kernels.hpp"

namespace bb::exec {

/// Puts stiffness times what the gap of the row misses in the place of force, and 0 in those of energy and stiffness; all three
/// are 0 in mollified rows. So gathering them is the force. Keys: smallest_key() of HoldTimes.
struct CurvatureCorrectionRows {
  RowView rows;
  SurfaceView surface;
  const double *x, *dx;  // [3 n_vertices]
  Key *curved, *straight;

  BB_HD void operator()(Index r) const {
    double force = 0;
    if (!rows.mollified(r) && rows.n_free(r) > 0) {
      const GapAlong gap = along(r);
      const double d = rows.d[r];
      atomic_min(gap.curved(d) ? curved : straight, smallest_key(gap.half_time(d)));
      force = rows.stiffness[r] * gap.missing(d);
    }
    rows.energy[r] = rows.stiffness[r] = 0;
    rows.force[r] = force > 0 ? force : 0;
  }

 private:
  BB_HD GapAlong along(Index r) const {
    Mat<double, 3, 4> moved = Mat<double, 3, 4>::Zero();
    for (int k = 0; k < 4; ++k) {
      if (!rows.is_free(r, k)) continue;
      const Index vertex = rows.vertex[k * rows.n + r];
      for (int c = 0; c < 3; ++c) moved(c, k) = dx[3 * vertex + c];
    }
    if (n_sliding(static_cast<ContactKind>(rows.kind[r])) == 0) return at_fixed_points(r, moved);
    GapAlong out{};
    with_row_shape(rows, surface, r, x, [&](const auto& shape) { out = gap_along(shape, moved); });
    return out;
  }
  BB_HD GapAlong at_fixed_points(Index r, const Mat<double, 3, 4>& moved) const {
    const RowCurvature at = row_curvature(rows, surface, r, x);
    return gap_along(rows.normal_of(r), at.flat, at.curvature, moved * weights_of(rows, r));
  }
};

}  // namespace bb::exec
