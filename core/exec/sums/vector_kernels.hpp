// What a Newton iteration does with columns of three numbers a vertex. fixed: [n] three bits a vertex, set where the
// degree of freedom is prescribed or locked.
#pragma once

#include <cmath>
#include <limits>

#include "core/exec/sums/sum_kernels.hpp"
#include "core/math/rounding_room.hpp"
#include "core/math/types.hpp"

namespace bb::exec {

/// out = x + alpha dx.
struct MoveAlong {
  const double *x, *dx;
  double alpha;
  double* out;
  BB_HD void operator()(Index i) const { out[i] = x[i] + alpha * dx[i]; }
};

/// Prescribed vertices to where they have to be.
struct PlacePins {
  const int* vertex;     // [pins]
  const double* target;  // [3 pins] m
  double* x;
  BB_HD void operator()(Index i) const {
    for (int k = 0; k < 3; ++k) x[3 * static_cast<Index>(vertex[i]) + k] = target[3 * i + k];
  }
};

/// dx of prescribed vertices: all the way to where they have to be.
struct PinMotion {
  const int* vertex;
  const double *target, *x;
  double* dx;
  BB_HD void operator()(Index i) const {
    for (int k = 0; k < 3; ++k) {
      const Index at = 3 * static_cast<Index>(vertex[i]) + k;
      dx[at] = target[3 * i + k] - x[at];
    }
  }
};

/// First pin that is not where it has to be.
struct FirstShortPin {
  const int* vertex;
  const double *target, *x;
  Key* first;
  BB_HD void operator()(Index i) const {
    bool apart = false;
    for (int k = 0; k < 3; ++k) {
      apart = apart || x[3 * static_cast<Index>(vertex[i]) + k] != target[3 * i + k];
    }
    if (apart) atomic_min(first, static_cast<Key>(i));
  }
};

/// Force of every vertex over its free degrees of freedom, N.
struct ForceNorm {
  const double* g;  // [3 n] N
  const FixedMask* fixed;
  double* force;
  BB_HD void operator()(Index v) const {
    Vec3d out(g[3 * v], g[3 * v + 1], g[3 * v + 2]);
    for (int k = 0; k < 3; ++k) {
      if (is_fixed(fixed[v], k)) out[k] = 0;
    }
    force[v] = out.norm();
  }
};

/// Of a direction: complements of keys (sum_kernels.hpp) of the largest |dx| over free entries, over those within the
/// rounding of their vertex, over the others, and of the largest length of a vertex's.
struct DirectionKeys {
  Key largest, within, beyond, vertex;
  BB_HD static DirectionKeys zero() { return {0, 0, 0, 0}; }
  friend BB_HD DirectionKeys operator+(const DirectionKeys& a, const DirectionKeys& b) {
    DirectionKeys out = a;
    raise_key(out.largest, b.largest), raise_key(out.within, b.within);
    raise_key(out.beyond, b.beyond), raise_key(out.vertex, b.vertex);
    return out;
  }
};

/// Parts of SumParts, one vertex an item.
struct DirectionParts {
  using Sum = DirectionKeys;
  const double *dx, *x;     // [3 n] m
  const double* body_size;  // [n] m
  const FixedMask* fixed;
  double epsilon;  // relative rounding of a coordinate
  BB_HD void operator()(Index v, DirectionKeys& sum) const {
    using std::abs;
    using std::sqrt;
    const double* const step = dx + 3 * v;
    for (int c = 0; c < 3; ++c) {
      if (is_fixed(fixed[v], c)) continue;
      const Key key = ~largest_key(abs(step[c]));
      const bool rounding = within_coordinate_rounding(step[c], x + 3 * v, body_size[v], epsilon);
      raise_key(sum.largest, key);
      raise_key(rounding ? sum.within : sum.beyond, key);
    }
    raise_key(sum.vertex, ~largest_key(sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2])));
  }
};

/// Parts of SumParts: dx += step, and b . step and g . dx over the free degrees of freedom.
struct TakeSolution {
  using Sum = TwoSums;
  const double *step, *b, *g;
  const FixedMask* fixed;
  double* dx;
  BB_HD void operator()(Index i, TwoSums& sum) const {
    dx[i] += step[i];
    if (is_fixed(fixed[i / 3], static_cast<int>(i % 3))) return;
    sum.first.add(b[i] * step[i]);
    sum.second.add(g[i] * dx[i]);
  }
};

/// b = -(g + lifted); lifted may be null.
struct RightHandSide {
  const double *g, *lifted;
  double* b;
  BB_HD void operator()(Index i) const { b[i] = -(lifted ? g[i] + lifted[i] : g[i]); }
};

/// y *= factor.
struct ScaleColumn {
  double factor;
  double* y;
  BB_HD void operator()(Index i) const { y[i] *= factor; }
};

/// First number of a column that is not finite.
struct FirstNotFinite {
  const double* values;
  Key* first;
  BB_HD void operator()(Index i) const {
    using std::abs;
    if (!(abs(values[i]) <= std::numeric_limits<double>::max())) atomic_min(first, static_cast<Key>(i));
  }
};

}  // namespace bb::exec
