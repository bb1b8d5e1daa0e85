// The moving polygon of a pair in integers: proofs of separation and of passage without any rounding. Slow,
// and used only for spans that floating point could not settle.
#pragma once

#include <gmpxx.h>

#include "core/audit/moving_pair.hpp"

namespace bb::audit {

template <class Pair>
class ExactPolygon {
 public:
  static constexpr int dim = Pair::dim, n_corners = Pair::n_corners;
  using Point = Vec<double, dim>;
  using Integers = std::array<mpz_class, static_cast<std::size_t>(dim)>;

  explicit ExactPolygon(const PairMotion<Pair>& m);

  /// True only if one of the directions of MovingPolygon::any_direction, taken at the middle of the span
  /// without rounding, strictly separates the origin from the polygon during the whole span.
  bool any_separates(const TimeSpan& span) const;

  /// True only if the origin provably passes through the polygon's interior within the span: seen along
  /// the fixed `direction` it stays strictly inside, and it is on opposite sides of the polygon's plane at
  /// the two ends.
  bool proves_passage(const Point& direction, const TimeSpan& span) const;

  /// Whether the origin is in the polygon's plane (2D: line) at all times, so that it never passes through it.
  bool stays_in_plane() const;

  /// Whether the origin is in the closed polygon at that time: the primitives meet.
  bool meets_at(std::int64_t t) const { return !any_separates({t, t}); }

 private:
  /// 2^50 (1 - t) begin + 2^50 t end, a positive multiple of the corner.
  Integers corner(int k, std::int64_t t) const;
  int plane_side(std::int64_t t) const;
  bool separates(const Integers& direction, const TimeSpan& span) const;

  std::array<Integers, static_cast<std::size_t>(n_corners)> begin_, end_;
};

extern template class ExactPolygon<VertexTriangle>;
extern template class ExactPolygon<EdgeEdge>;
extern template class ExactPolygon<VertexEdge2d>;

}  // namespace bb::audit
