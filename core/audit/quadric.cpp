#include "core/audit/quadric.hpp"

namespace bb::audit {
namespace {

/// |w0 + t (w1 - w0)| < radius for some t in [0, 1].
bool segment_comes_near(const Rational3& w0, const Rational3& w1, const mpq_class& radius_sq) {
  const Rational3 step = minus(w1, w0);
  const mpq_class a = dot(step, step), b = dot(w0, step), c = dot(w0, w0) - radius_sq;
  const mpq_class end = a + 2 * b + c;
  if (sgn(c) < 0 || sgn(end) < 0) return true;
  const bool lowest_within = sgn(b) < 0 && b + a > 0;  // a t^2 + 2 b t + c is lowest at -b / a
  return lowest_within && b * b > a * c;
}

/// The plane of the three comes nearer to the origin than the radius, and its foot is in the triangle.
bool face_comes_near(const std::array<Rational3, 3>& w, const mpq_class& radius_sq) {
  const Rational3 n = cross(minus(w[1], w[0]), minus(w[2], w[0]));
  const mpq_class height = dot(n, w[0]), length_sq = dot(n, n);
  if (sgn(length_sq) == 0 || height * height >= radius_sq * length_sq) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    if (sgn(dot(n, cross(w[k], w[(k + 1) % 3]))) < 0) return false;
  }
  return true;
}

}  // namespace

bool simplex_comes_near(const std::array<Rational3, 2>& arms, const mpq_class& radius_sq) {
  return segment_comes_near(arms[0], arms[1], radius_sq);
}

bool simplex_comes_near(const std::array<Rational3, 3>& arms, const mpq_class& radius_sq) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (segment_comes_near(arms[k], arms[(k + 1) % 3], radius_sq)) return true;
  }
  return face_comes_near(arms, radius_sq);
}

}  // namespace bb::audit
