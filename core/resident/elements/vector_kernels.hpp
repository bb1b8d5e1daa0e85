// What a Newton iteration does with columns of three numbers a vertex. fixed: [n] three bits a vertex, set where the
// degree of freedom is prescribed or locked.
#pragma once

#include <cmath>
#include <limits>

#include "core/math/rounding_room.hpp"
#include "core/math/types.hpp"
#include "core/resident/linear/resident_matrix.hpp"
#include "core/resident/sums/sum_kernels.hpp"

namespace bb::resident {

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
    if (apart) exec::atomic_min(first, static_cast<Key>(i));
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

/// Size of one part of the free entries of dx: those within the rounding of their vertex, or the others.
struct RoundingSize {
  const double *dx, *x;     // [3 n] m
  const double* body_size;  // [n] m
  const FixedMask* fixed;
  bool within;
  BB_HD Key operator()(Index i) const {
    const Index v = i / 3;
    if (is_fixed(fixed[v], static_cast<int>(i % 3))) return largest_key(0);
    const double epsilon = std::numeric_limits<double>::epsilon();
    const bool rounding = within_coordinate_rounding(dx[i], x + 3 * v, body_size[v], epsilon);
    using std::abs;
    return largest_key(rounding == within ? abs(dx[i]) : 0);
  }
};

/// First number of a column that is not finite.
struct FirstNotFinite {
  const double* values;
  Key* first;
  BB_HD void operator()(Index i) const {
    using std::abs;
    if (!(abs(values[i]) <= std::numeric_limits<double>::max())) exec::atomic_min(first, static_cast<Key>(i));
  }
};

/// Largest length of a column of three numbers.
struct ColumnNorms {
  const double* x;
  BB_HD Key operator()(Index v) const {
    using std::sqrt;
    return largest_key(sqrt(x[3 * v] * x[3 * v] + x[3 * v + 1] * x[3 * v + 1] + x[3 * v + 2] * x[3 * v + 2]));
  }
};

}  // namespace bb::resident
