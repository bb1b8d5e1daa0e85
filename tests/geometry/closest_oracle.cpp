// The enumeration itself: compiled once for all tests.
#include "tests/geometry/closest_oracle.hpp"

#include <algorithm>

#include "tests/oracle/dense.hpp"

namespace bb::test {

namespace {

/// Minimises |sum w x| over one face of each primitive (bit i of `faces`: point i takes
/// part), without bounds.
OracleClosest<4> minimise_over(const Points<Long, 4>& x, int n, int split, unsigned faces) {
  int origin[2] = {-1, -1};  // of the first and the second primitive
  int moved[4], base[4], n_free = 0;
  MatXl directions(3, 4);
  for (int i = 0; i < n; ++i) {
    if ((faces >> i & 1U) == 0) continue;
    int& start = origin[i < split ? 0 : 1];
    if (start < 0) {
      start = i;
      continue;
    }
    moved[n_free] = i;
    base[n_free] = start;
    directions.col(n_free++) = x.col(i) - x.col(start);
  }
  OracleClosest<4> out;
  if (origin[0] < 0 || origin[1] < 0) return out;
  out.weights[origin[0]] = 1;
  out.weights[origin[1]] = -1;
  out.r = x.col(origin[0]) - x.col(origin[1]);
  if (n_free > 0) {
    const VecXl s = least_squares(directions.leftCols(n_free), -out.r);
    for (int k = 0; k < n_free; ++k) {
      out.weights[moved[k]] += s[k];
      out.weights[base[k]] -= s[k];
      out.r += s[k] * directions.col(k);
    }
  }
  out.d = out.r.norm();
  out.least_weight = 1;
  for (int i = 0; i < n; ++i) {
    if ((faces >> i & 1U) == 0) continue;
    out.least_weight = std::min(out.least_weight, i < split ? out.weights[i] : -out.weights[i]);
  }
  return out;
}

}  // namespace

OracleClosest<4> enumerate_faces(const Points<Long, 4>& x, int n, int split) {
  OracleClosest<4> best;
  for (unsigned faces = 1; faces < (1U << n); ++faces) {
    const OracleClosest<4> candidate = minimise_over(x, n, split, faces);
    if (candidate.least_weight >= 0 && candidate.d < best.d) best = candidate;
  }
  return best;
}

Mat3d random_rotation(std::mt19937& rng) {
  Mat3d q = orthonormal_basis(random_points<3>(rng).cast<Long>()).cast<double>();
  if (q.determinant() < 0) q.col(0) *= -1;
  return q;
}

}  // namespace bb::test
