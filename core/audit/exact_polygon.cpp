// Integer arithmetic of one pair. Every vector carries a positive factor of its own; signs of
// products are kept.
#include "core/audit/exact_polygon.hpp"

#include "core/audit/exact_integers.hpp"

namespace bb::audit {
namespace {

template <std::size_t N>
mpz_class dot(const std::array<mpz_class, N>& a, const std::array<mpz_class, N>& b) {
  mpz_class sum = 0;
  for (std::size_t k = 0; k < N; ++k) sum += a[k] * b[k];
  return sum;
}

std::array<mpz_class, 3> cross(const std::array<mpz_class, 3>& a, const std::array<mpz_class, 3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <std::size_t N>
std::array<mpz_class, N> minus(const std::array<mpz_class, N>& a, const std::array<mpz_class, N>& b) {
  std::array<mpz_class, N> out;
  for (std::size_t k = 0; k < N; ++k) out[k] = a[k] - b[k];
  return out;
}

template <std::size_t N>
std::array<mpz_class, N> integers(const Vec<double, static_cast<int>(N)>& v) {
  const std::vector<mpz_class> z = to_integers({v.data(), N});
  std::array<mpz_class, N> out;
  for (std::size_t k = 0; k < N; ++k) out[k] = z[k];
  return out;
}

}  // namespace

template <class Pair>
ExactPolygon<Pair>::ExactPolygon(const PairMotion<Pair>& m) {
  constexpr auto n_points = static_cast<std::size_t>(Pair::n_points), n_dim = static_cast<std::size_t>(dim);
  std::vector<double> raw;
  for (const auto* ends : {&m.x0, &m.x1}) {
    for (const Point& p : *ends) raw.insert(raw.end(), p.data(), p.data() + dim);
  }
  const std::vector<mpz_class> z = to_integers(raw);
  for (std::size_t c = 0; c < begin_.size(); ++c) {
    const auto i = static_cast<std::size_t>(Pair::corner[c][0]),
               j = static_cast<std::size_t>(Pair::corner[c][1]);
    for (std::size_t k = 0; k < n_dim; ++k) {
      begin_[c][k] = z[i * n_dim + k] - z[j * n_dim + k];
      end_[c][k] = z[(n_points + i) * n_dim + k] - z[(n_points + j) * n_dim + k];
    }
  }
}

template <class Pair>
typename ExactPolygon<Pair>::Integers ExactPolygon<Pair>::corner(int k, std::int64_t t) const {
  const auto c = static_cast<std::size_t>(k);
  const mpz_class s = static_cast<long>(t), r = static_cast<long>(TimeSpan::one - t);
  Integers out;
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = r * begin_[c][i] + s * end_[c][i];
  return out;
}

template <class Pair>
bool ExactPolygon<Pair>::separates(const Integers& direction, const TimeSpan& span) const {
  int side = 0;
  for (int k = 0; k < n_corners; ++k) {
    for (std::int64_t t : {span.begin, span.end}) {
      const int s = sgn(dot(direction, corner(k, t)));
      if (s == 0 || s == -side) return false;
      side = s;
    }
  }
  return true;
}

template <class Pair>
bool ExactPolygon<Pair>::any_separates(const TimeSpan& span) const {
  const std::int64_t t = span.middle();
  std::array<Integers, static_cast<std::size_t>(n_corners)> at, side;
  for (std::size_t k = 0; k < at.size(); ++k) at[k] = corner(static_cast<int>(k), t);
  for (std::size_t k = 0; k < at.size(); ++k) side[k] = minus(at[(k + 1) % at.size()], at[k]);
  if constexpr (dim == 3) {
    if (separates(cross(side[0], side[1]), span)) return true;
  } else {
    if (separates({mpz_class(-side[0][1]), side[0][0]}, span)) return true;
  }
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (separates(at[k], span)) return true;
    // The part of the corner orthogonal to the side, times the side's squared length.
    const mpz_class length_sq = dot(side[k], side[k]), along = dot(at[k], side[k]);
    Integers foot;
    for (std::size_t i = 0; i < foot.size(); ++i) foot[i] = at[k][i] * length_sq - side[k][i] * along;
    if (separates(foot, span)) return true;
  }
  return false;
}

template <class Pair>
int ExactPolygon<Pair>::plane_side(std::int64_t t) const {
  if constexpr (dim == 3) {
    return sgn(dot(corner(0, t), cross(corner(1, t), corner(2, t))));
  } else {
    const Integers a = corner(0, t), b = corner(1, t);
    return sgn(mpz_class(a[0] * b[1] - a[1] * b[0]));
  }
}

template <class Pair>
bool ExactPolygon<Pair>::proves_passage(const Point& direction, const TimeSpan& span) const {
  if (plane_side(span.begin) * plane_side(span.end) >= 0) return false;
  const Integers n = integers<static_cast<std::size_t>(dim)>(direction);
  if constexpr (dim == 2) {  // the line through the origin along n keeps the two corners strictly apart
    const auto side = [&](int k, std::int64_t t) {
      const Integers d = corner(k, t);
      return sgn(mpz_class(n[0] * d[1] - n[1] * d[0]));
    };
    const int s = side(0, span.begin);
    return s != 0 && side(0, span.end) == s && side(1, span.begin) == -s && side(1, span.end) == -s;
  } else {  // n.(D_k x D_k+1) is a quadratic in t: strict and equal signs of its Bernstein coefficients bound
            // it
    int common = 0;
    for (int k = 0; k < n_corners; ++k) {
      const int next = (k + 1) % n_corners;
      const Integers a0 = corner(k, span.begin), a1 = corner(k, span.end);
      const Integers b0 = corner(next, span.begin), b1 = corner(next, span.end);
      const mpz_class middle = dot(n, cross(a0, b1)) + dot(n, cross(a1, b0));
      for (const int s : {sgn(dot(n, cross(a0, b0))), sgn(middle), sgn(dot(n, cross(a1, b1)))}) {
        if (s == 0 || s == -common) return false;
        common = s;
      }
    }
    return true;
  }
}

// The height over the plane is a polynomial of the degree dim in time: it has no more zeros than that, or is zero.
template <class Pair>
bool ExactPolygon<Pair>::stays_in_plane() const {
  for (int k = 0; k <= dim; ++k) {
    if (plane_side(TimeSpan::one / 4 * k) != 0) return false;
  }
  return true;
}

template class ExactPolygon<VertexTriangle>;
template class ExactPolygon<EdgeEdge>;
template class ExactPolygon<VertexEdge2d>;

}  // namespace bb::audit
