// Floating filter first, integers where it cannot decide.
#include "core/audit/predicates.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "core/audit/exact_integers.hpp"

namespace bb::audit {

std::vector<mpz_class> to_integers(std::span<const double> values) {
  constexpr int digits = 53;
  int lowest = 0;
  bool any = false;
  for (double v : values) {
    if (v == 0.0) continue;
    int e = 0;
    std::frexp(v, &e);
    lowest = any ? std::min(lowest, e - digits) : e - digits;
    any = true;
  }
  std::vector<mpz_class> out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i] == 0.0) continue;
    int e = 0;
    const double mantissa = std::frexp(values[i], &e);
    out[i] = static_cast<long>(std::ldexp(mantissa, digits));
    out[i] <<= static_cast<mp_bitcnt_t>(e - digits - lowest);
  }
  return out;
}

namespace {

// A term of a determinant passes 8 roundings in 3D (3 differences, 3 for its product and minor, 2 sums) and
// 4 in 2D, each at most 2^-53 relative; the permanent is itself rounded down by at most as many. 2^-49
// covers both twice.
constexpr double filter = 0x1p-49;
// Underflow adds at most 2^-1070 (1 + largest factor); with factors below 2^300 that is below this.
constexpr double underflow = 0x1p-700;
constexpr double largest = 0x1p300;

int sign_of(double v) { return (v > 0.0) - (v < 0.0); }

mpz_class det3(const mpz_class* r, const mpz_class* s, const mpz_class* t) {
  return r[0] * (s[1] * t[2] - s[2] * t[1]) + r[1] * (s[2] * t[0] - s[0] * t[2]) +
         r[2] * (s[0] * t[1] - s[1] * t[0]);
}

}  // namespace

int orient2d_exact(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  const std::array<double, 6> raw{a[0], a[1], b[0], b[1], c[0], c[1]};
  const std::vector<mpz_class> z = to_integers(raw);
  const mpz_class det = (z[2] - z[0]) * (z[5] - z[1]) - (z[3] - z[1]) * (z[4] - z[0]);
  return sgn(det);
}

int orient3d_exact(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const std::array<double, 12> raw{a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], d[0], d[1], d[2]};
  std::vector<mpz_class> z = to_integers(raw);
  for (std::size_t i = 3; i < 12; ++i) z[i] -= z[i % 3];
  const mpz_class det = det3(&z[3], &z[6], &z[9]);
  return sgn(det);
}

int orient2d(const Vec2d& a, const Vec2d& b, const Vec2d& c) {
  const double l = (b[0] - a[0]) * (c[1] - a[1]);
  const double r = (b[1] - a[1]) * (c[0] - a[0]);
  const double det = l - r;
  const double permanent = std::abs(l) + std::abs(r);
  if (std::abs(det) > filter * permanent + underflow && permanent < largest) return sign_of(det);
  return orient2d_exact(a, b, c);
}

int orient3d(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const Vec3d r = b - a, s = c - a, t = d - a;
  const double m0l = s[1] * t[2], m0r = s[2] * t[1];
  const double m1l = s[2] * t[0], m1r = s[0] * t[2];
  const double m2l = s[0] * t[1], m2r = s[1] * t[0];
  const double det = r[0] * (m0l - m0r) + r[1] * (m1l - m1r) + r[2] * (m2l - m2r);
  const double permanent = std::abs(r[0]) * (std::abs(m0l) + std::abs(m0r)) +
                           std::abs(r[1]) * (std::abs(m1l) + std::abs(m1r)) +
                           std::abs(r[2]) * (std::abs(m2l) + std::abs(m2r));
  const double factor = r.cwiseAbs().cwiseMax(s.cwiseAbs()).cwiseMax(t.cwiseAbs()).maxCoeff();
  if (std::abs(det) > filter * permanent + underflow && factor < largest) return sign_of(det);
  // A plane of constant coordinate, or coincident points: differences of doubles are zero only
  // if exactly zero.
  for (int k = 0; k < 3; ++k) {
    if (r[k] == 0.0 && s[k] == 0.0 && t[k] == 0.0) return 0;
  }
  if (r.isZero(0.0) || s.isZero(0.0) || t.isZero(0.0)) return 0;
  return orient3d_exact(a, b, c, d);
}

bool predicates_self_test() {
  // (1 + 2^-27)^2 needs 55 bits: rounded and contracted evaluations of x x - round(x x) differ.
  volatile double x = 1.0 + 0x1p-27;
  volatile double square = x * x;
  const double y = x;
  if (y * y - square != 0.0) return false;
  // Points moved by single ulps off a line and a plane, so that rounding decides every naive sign.
  std::uint64_t state = 88172645463325252ULL;
  const auto ulps = [&state] {
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    return static_cast<double>(static_cast<int>(state % 5) - 2) * 0x1p-52;
  };
  const auto around = [&ulps](double px, double py, double pz) {
    return Vec3d(px + ulps(), py + ulps(), pz + ulps());
  };
  int seen[3] = {0, 0, 0};
  for (int i = 0; i < 300; ++i) {
    const Vec3d a = around(0.5, 0.5, 0.5), b = around(12.0, 1.0, 12.0), c = around(24.0, 0.25, 24.0),
                d = around(1.0, 7.0, 1.0);
    const int s3 = orient3d_exact(a, b, c, d);
    const Vec2d p = a.head<2>(), q(12.0, 12.0), r(24.0, 24.0);
    if (orient3d(a, b, c, d) != s3 || orient2d(p, q, r) != orient2d_exact(p, q, r)) return false;
    ++seen[s3 + 1];
  }
  return seen[0] > 0 && seen[2] > 0;
}

}  // namespace bb::audit
