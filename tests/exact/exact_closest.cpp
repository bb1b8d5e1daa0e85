#include "tests/exact/exact_closest.hpp"

#include <algorithm>
#include <cmath>

namespace bb::test {
namespace {

using Point = ExactPair::Point;
constexpr unsigned bits = 256;

Point difference(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
mpz_class dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Least |r + sum_k s_k d_k| over all s; `s` are numerators over `den` > 0. False when the directions are dependent:
/// then a smaller face has the same distance.
struct LeastSquares {
  mpz_class num, den;  // squared distance
  std::array<mpz_class, 2> s;
  bool solved = true;
};

LeastSquares least_squares(const Point& r, const std::vector<Point>& d) {
  LeastSquares out;
  const mpz_class rr = dot(r, r);
  if (d.empty()) {
    out.num = rr, out.den = 1;
    return out;
  }
  const mpz_class aa = dot(d[0], d[0]), ra = dot(r, d[0]);
  if (d.size() == 1) {
    out.solved = aa != 0;
    out.den = aa, out.num = rr * aa - ra * ra, out.s[0] = -ra;
    return out;
  }
  const mpz_class bb = dot(d[1], d[1]), ab = dot(d[0], d[1]), rb = dot(r, d[1]);
  out.den = aa * bb - ab * ab;
  out.solved = out.den != 0;
  out.s[0] = rb * ab - ra * bb;
  out.s[1] = ra * ab - rb * aa;
  out.num = rr * out.den + ra * out.s[0] + rb * out.s[1];
  return out;
}

bool closer(const ExactDistance& a, const ExactDistance& b) {
  return b.den == 0 || cmp(mpz_class(a.num * b.den), mpz_class(b.num * a.den)) < 0;
}

/// The distance of the affine hulls of one face of each primitive, when the closest points are inside both.
bool face_distance(const ExactPair& pair, unsigned faces, ExactDistance& out) {
  int origin[2] = {-1, -1};
  std::vector<Point> directions;
  std::vector<int> side;  // of each direction
  const int n = static_cast<int>(pair.x.size());
  for (int i = 0; i < n; ++i) {
    if ((faces >> i & 1U) == 0) continue;
    const int of = i < pair.split ? 0 : 1;
    if (origin[of] < 0) {
      origin[of] = i;
      continue;
    }
    directions.push_back(
        difference(pair.x[static_cast<std::size_t>(i)], pair.x[static_cast<std::size_t>(origin[of])]));
    side.push_back(of);
  }
  if (origin[0] < 0 || origin[1] < 0) return false;
  const Point r =
      difference(pair.x[static_cast<std::size_t>(origin[0])], pair.x[static_cast<std::size_t>(origin[1])]);
  const LeastSquares best = least_squares(r, directions);
  if (!best.solved) return false;
  // Weights of the second primitive are negative: its s are <= 0 and sum to at least -1.
  std::array<mpz_class, 2> sum{0, 0};
  for (std::size_t k = 0; k < side.size(); ++k) {
    const mpz_class weight = side[k] == 0 ? best.s[k] : mpz_class(-best.s[k]);
    if (weight < 0) return false;
    sum[static_cast<std::size_t>(side[k])] += weight;
  }
  if (sum[0] > best.den || sum[1] > best.den) return false;
  out = {best.num, best.den, faces};
  return true;
}

mpf_class root(const ExactDistance& distance) {
  const mpf_class quotient = mpf_class(distance.num, bits) / mpf_class(distance.den, bits);
  return sqrt(quotient);
}

mpf_class times_power(mpf_class value, long exponent) {
  if (exponent >= 0) {
    mpf_mul_2exp(value.get_mpf_t(), value.get_mpf_t(), static_cast<mp_bitcnt_t>(exponent));
  } else {
    mpf_div_2exp(value.get_mpf_t(), value.get_mpf_t(), static_cast<mp_bitcnt_t>(-exponent));
  }
  return value;
}

double in_units(const mpf_class& value, double unit) {
  return unit > 0 ? mpf_class(value / mpf_class(unit, bits)).get_d() : value.get_d();
}

/// value = integer 2^exponent with an odd or zero integer.
std::pair<mpz_class, long> integer_of(double value) {
  int exponent = 0;
  const double mantissa = std::ldexp(std::frexp(value, &exponent), 53);
  return {mpz_class(mantissa), static_cast<long>(exponent) - 53};
}

}  // namespace

ExactPair exact_pair(const Eigen::Ref<const Mat<double, 3, Eigen::Dynamic>>& x, int split) {
  ExactPair out;
  out.split = split;
  long least = 4000;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double c = x(i % 3, i / 3);
    if (c != 0) least = std::min(least, integer_of(c).second);
  }
  out.exponent = least == 4000 ? 0 : least;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    Point p;
    for (Eigen::Index k = 0; k < 3; ++k) {
      const auto [integer, exponent] = integer_of(x(k, i));
      p[static_cast<std::size_t>(k)] =
          integer == 0 ? integer : mpz_class(integer << static_cast<mp_bitcnt_t>(exponent - out.exponent));
    }
    out.x.push_back(p);
  }
  return out;
}

ExactDistance exact_distance(const ExactPair& pair, unsigned within) {
  ExactDistance best;
  for (unsigned faces = 1; faces < (1U << pair.x.size()); ++faces) {
    ExactDistance candidate;
    if ((faces & ~within) == 0 && face_distance(pair, faces, candidate) && closer(candidate, best))
      best = candidate;
  }
  return best;
}

unsigned region_points(Region region) {
  switch (region) {
    case Region::p_p:
      return 0b0011;
    case Region::p_e0:
      return 0b0011;
    case Region::p_e1:
      return 0b0101;
    case Region::p_e:
      return 0b0111;
    case Region::p_t0:
      return 0b0011;
    case Region::p_t1:
      return 0b0101;
    case Region::p_t2:
      return 0b1001;
    case Region::p_e01:
      return 0b0111;
    case Region::p_e12:
      return 0b1101;
    case Region::p_e20:
      return 0b1011;
    case Region::p_t:
      return 0b1111;
    case Region::ea0_eb0:
      return 0b0101;
    case Region::ea0_eb1:
      return 0b1001;
    case Region::ea1_eb0:
      return 0b0110;
    case Region::ea1_eb1:
      return 0b1010;
    case Region::ea_eb0:
      return 0b0111;
    case Region::ea_eb1:
      return 0b1011;
    case Region::ea0_eb:
      return 0b1101;
    case Region::ea1_eb:
      return 0b1110;
    case Region::ea_eb:
      return 0b1111;
  }
  return 0;
}

ExactDistance exact_combination(const ExactPair& pair, const std::vector<double>& weights) {
  long least = 0;
  for (const double w : weights) {
    if (w != 0) least = std::min(least, integer_of(w).second);
  }
  Point sum{0, 0, 0};
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const auto [integer, exponent] = integer_of(weights[i]);
    if (integer == 0) continue;
    const mpz_class w = integer << static_cast<mp_bitcnt_t>(exponent - least);
    for (std::size_t k = 0; k < 3; ++k) sum[k] += w * (pair.x[i][k] - pair.x[0][k]);
  }
  ExactDistance out;
  out.num = dot(sum, sum);
  out.den = mpz_class(1) << static_cast<mp_bitcnt_t>(-2 * least);
  return out;
}

double error_in(double unit, double value, const ExactDistance& distance, long exponent) {
  return in_units(mpf_class(value, bits) - times_power(root(distance), exponent), unit);
}

double excess_in(double unit, const ExactDistance& a, const ExactDistance& b, long exponent) {
  return in_units(times_power(root(a) - root(b), exponent), unit);
}

}  // namespace bb::test
