// Pairs that pass each other by 2^-40 to 2^-60 of their size, on either side or exactly: every coordinate is a double without rounding,
// so that what is true is known by construction.
#include <gtest/gtest.h>

#include "core/audit/motion_audit.hpp"
#include "core/audit/pair_verdict.hpp"
#include "core/audit/state_audit.hpp"
#include "tests/audit/small_scenes.hpp"

namespace bb::audit::touch_within_rounding_test {
namespace {

enum class Side { beside, exactly, through };

/// What is nearer than that many bits of the size of a pair may be left open, but is never taken for the other.
constexpr int decided_bits = 48;
/// Of coordinates: products of them are rounded.
constexpr double tail = 0x1p-30;

/// Shears, rotates coordinates, mirrors some and scales by a power of two: all exact. A shear takes digits.
Vec3d seen(Vec3d x, unsigned how, bool sheared) {
  if (sheared) {
    x[0] += (static_cast<int>(how % 5) - 2) * x[1] + (static_cast<int>(how % 3) - 1) * x[2];
    x[1] += (static_cast<int>(how % 4) - 1) * x[2];
    x[2] += (static_cast<int>(how % 2) * 2 - 1) * x[0];
  }
  const int first = static_cast<int>(how % 3);
  Vec3d out(x[first], x[(first + 1) % 3], x[(first + 2) % 3]);
  for (int k = 0; k < 3; ++k)
    if ((how / 3 >> k & 1U) != 0) out[k] = -out[k];
  return std::ldexp(1.0, static_cast<int>(how % 7) - 3) * out;
}

void expect(Verdict found, Side side, int bits, const std::string& where) {
  const bool open = bits > decided_bits && found == Verdict::unproven;
  if (side == Side::beside) {
    EXPECT_TRUE(found == Verdict::certified || open) << where;
  } else if (side == Side::through) {
    EXPECT_TRUE(found == Verdict::violation || open) << where;
  } else {
    EXPECT_NE(found, Verdict::certified) << where;
  }
}

template <class Pair>
using Motion = PairMotion<Pair>;

/// The pair falls from z = up to z = -down across a primitive that stands still, and meets its plane `by` beside its border.
template <class Pair>
void expect_verdicts(const std::function<void(double by, double up, double down, Motion<Pair>&)>& make,
                     double tolerance, int& judged) {
  for (unsigned how = 0; how < 24; ++how) {
    for (int bits = 40; bits <= 60; ++bits) {
      for (const Side side : {Side::beside, Side::exactly, Side::through}) {
        for (const auto& [up, down] : {std::pair{1 + tail, 1.0}, {1.0, 2 - tail}, {0.25 - tail, 3.0}}) {
          const double by = side == Side::exactly ? 0 : std::ldexp(side == Side::through ? 1.0 : -1.0, -bits);
          Motion<Pair> motion;
          make(by, up, down, motion);
          for (auto* end : {&motion.x0, &motion.x1}) {
            for (auto& x : *end) {
              const Vec3d turned = seen(Vec3d(x), how, bits <= decided_bits - 4);
              x = turned;
            }
          }
          const Verdict found = judge(motion, tolerance);
          const std::string where = std::to_string(bits) + " bits, seen " + std::to_string(how);
          expect(found, side, bits, where);
          ++judged;
        }
      }
      if (testing::Test::HasFailure()) return;
    }
  }
}

TEST(TouchWithinRounding, OfAVertexBesideTheSideOfATriangle) {
  int judged = 0;
  expect_verdicts<VertexTriangle>(
      [](double by, double up, double down, auto& motion) {
        motion.x0 = {Vec3d(by, 0.25 + tail, up), Vec3d(0, -3 * tail, 0), Vec3d(1 - tail, 0, 0),
                     Vec3d(0, 1 + 5 * tail, 0)};
        motion.x1 = motion.x0;
        motion.x1[0][2] = -down;
      },
      tolerance, judged);
  EXPECT_EQ(judged, 24 * 21 * 9);
}

TEST(TouchWithinRounding, OfAnEdgeBesideTheEndOfAnother) {
  int judged = 0;
  expect_verdicts<EdgeEdge>(
      [](double by, double up, double down, auto& motion) {
        motion.x0 = {Vec3d(by, -1 - tail, up), Vec3d(by, 1 - tail, up), Vec3d(0, 0, 0),
                     Vec3d(1 + 3 * tail, 0, 0)};
        motion.x1 = motion.x0;
        motion.x1[0][2] = motion.x1[1][2] = -down;
      },
      tolerance, judged);
  EXPECT_EQ(judged, 24 * 21 * 9);
}

/// The tip of a moving edge comes as near to a triangle's plane as that, and turns back: it does not pass, by `by`.
TEST(TouchWithinRounding, OfAVertexThatStopsShortOfAPlane) {
  int judged = 0;
  for (int bits = 40; bits <= 60; ++bits) {
    for (const double sign : {1.0, 0.0, -1.0}) {
      PairMotion<VertexTriangle> motion;
      const double by = std::ldexp(sign, -bits);
      motion.x0 = {Vec3d(0.25, 0.25, 1), Vec3d(0, 0, 0), Vec3d(1, 0, 0), Vec3d(0, 1, 0)};
      motion.x1 = motion.x0;
      motion.x1[0][2] = by;
      const Side side = sign > 0 ? Side::beside : sign < 0 ? Side::through : Side::exactly;
      expect(judge(motion, tolerance), side, bits, std::to_string(bits) + " bits short of the plane");
      ++judged;
    }
  }
  EXPECT_EQ(judged, 63);
}

/// States: an edge through a triangle, or beside it, by as little.
TEST(TouchWithinRounding, OfAnEdgeAndATriangleThatStandStill) {
  constexpr double y = 0.25 + tail / 2, low = -1 - tail, high = 2 + 2 * tail;
  for (unsigned how = 0; how < 24; ++how) {
    for (int bits = 40; bits <= 60; ++bits) {
      for (const double sign : {1.0, 0.0, -1.0}) {
        const double by = std::ldexp(sign, -bits);
        Positions x(3, 6);
        x << 0, 1 - tail, 0, by, by, by - 1,         //
            -3 * tail, tail, 1 + 5 * tail, y, y, y,  //
            0, 0, 0, low, high, 0.5;
        for (int v = 0; v < 6; ++v) x.col(v) = seen(x.col(v), how, bits <= decided_bits);
        const StateAudit found = audit_state(two_triangles(), x, true);
        EXPECT_EQ(found.crossings > 0, sign > 0) << bits << " " << how;
        EXPECT_EQ(found.touches > 0, sign == 0) << bits << " " << how;
        EXPECT_TRUE(found.pairs > 0 || sign < 0) << "boxes that do not meet";
      }
    }
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace bb::audit::touch_within_rounding_test
