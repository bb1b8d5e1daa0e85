#include "core/contact/far_test.hpp"

#include <algorithm>
#include <bit>

#include "core/contact/chunks.hpp"
#include "core/contact/float_rounding.hpp"

namespace bb {
namespace {

using Four = TreeBox::Four;

/// Coordinates of eight points, one vector per axis.
void transpose(const Four (&points)[FarTest::width], EightFloats (&axis)[3]) {
  EightFloats p[4];
  for (int k = 0; k < 4; ++k) {
    p[k] = __builtin_shufflevector(points[k], points[k + 4], 0, 1, 2, 3, 4, 5, 6, 7);
  }
  const EightFloats xy01 = __builtin_shufflevector(p[0], p[1], 0, 8, 1, 9, 4, 12, 5, 13);
  const EightFloats xy23 = __builtin_shufflevector(p[2], p[3], 0, 8, 1, 9, 4, 12, 5, 13);
  const EightFloats z01 = __builtin_shufflevector(p[0], p[1], 2, 10, 3, 11, 6, 14, 7, 15);
  const EightFloats z23 = __builtin_shufflevector(p[2], p[3], 2, 10, 3, 11, 6, 14, 7, 15);
  axis[0] = __builtin_shufflevector(xy01, xy23, 0, 1, 8, 9, 4, 5, 12, 13);
  axis[1] = __builtin_shufflevector(xy01, xy23, 2, 3, 10, 11, 6, 7, 14, 15);
  axis[2] = __builtin_shufflevector(z01, z23, 0, 1, 8, 9, 4, 5, 12, 13);
}

/// 1 over the power of two that is nearest below each number, which must be positive and normal: factors that round
/// nothing.
EightFloats inverse_powers_of_two(const EightFloats& of) {
  constexpr std::int32_t exponent = 0x7f800000, twice_bias = 254 << 23;
  return std::bit_cast<EightFloats>(twice_bias - (std::bit_cast<EightInts>(of) & exponent));
}

}  // namespace

template <int N>
std::vector<FarTest::Corners> FarTest::corners(const Primitives<N>& primitives) {
  std::vector<Corners> out(primitives.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    std::copy(primitives.vertices[i].begin(), primitives.vertices[i].end(), out[i].vertex);
    out[i].reach = float_above(primitives.side[i].d_hat / 2 + primitives.side[i].offset);
  }
  return out;
}

FarTest::FarTest(const Surface& surface, Precision precision)
    : precision_(precision),
      points_(corners(surface.points)),
      edges_(corners(surface.edges)),
      triangles_(corners(surface.triangles)) {}

void FarTest::set_state(const PositionsView& x) {
  x_.resize(static_cast<std::size_t>(x.cols()));
  for_each_chunk(x_.size(), [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto p = x.col(static_cast<int>(i));
      const double blur =
          values_in_float(precision_) ? distance_rounding(precision_, p.lpNorm<Eigen::Infinity>()) : 0;
      x_[i] = Point{p[0], p[1], p[2], blur};
    }
  });
}

template <PairKind K>
LaneSet FarTest::far(const IndexPair* pairs, std::size_t n) const {
  constexpr int N = pair_points(K), split = pair_split(K);
  const Point* corner[N][width];
  EightFloats reach;
  for (std::size_t lane = 0; lane < width; ++lane) {
    const IndexPair pair = pairs[lane < n ? lane : 0];
    const Corners& a = first<K>()[static_cast<std::size_t>(pair.first)];
    const Corners& b = second<K>()[static_cast<std::size_t>(pair.second)];
    for (int k = 0; k < N; ++k) {
      corner[k][lane] = &x_[static_cast<std::size_t>(k < split ? a.vertex[k] : b.vertex[k - split])];
    }
    reach[lane] = a.reach + b.reach;
  }
  if (values_in_float(precision_)) {  // the distance is rounded by as much as its largest coordinate requires
    for (std::size_t lane = 0; lane < width; ++lane) {
      double blur = 0;
      for (int k = 0; k < N; ++k) blur = std::max(blur, (*corner[k][lane])[3]);
      reach[lane] += float_above(blur);
    }
  }
  const EightFloats unit = inverse_powers_of_two(reach);
  PairLanes<K, Lanes8> points;
  Four from_first[width];
  EightFloats point[3];
  for (int c = 0; c < 3; ++c) points.x[0][c] = EightFloats{};
  for (int k = 1; k < N; ++k) {
    for (std::size_t lane = 0; lane < width; ++lane) {
      from_first[lane] = __builtin_convertvector(*corner[k][lane] - *corner[0][lane], Four);
    }
    transpose(from_first, point);
    for (int c = 0; c < 3; ++c) points.x[k][c] = point[c] * unit;
  }
  // the sum of two sides is rounded once or twice
  const Lanes8 level = Lanes8(reach * unit * (1 + 0x1p-20f));
  return lanes_of(farther_than<K>(points, level).bits) & ((LaneSet{1} << n) - 1);
}

template LaneSet FarTest::far<PairKind::point_point>(const IndexPair*, std::size_t) const;
template LaneSet FarTest::far<PairKind::point_edge>(const IndexPair*, std::size_t) const;
template LaneSet FarTest::far<PairKind::point_triangle>(const IndexPair*, std::size_t) const;
template LaneSet FarTest::far<PairKind::edge_edge>(const IndexPair*, std::size_t) const;

}  // namespace bb
