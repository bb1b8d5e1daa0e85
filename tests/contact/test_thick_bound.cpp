// Thickness in every bound on a time: bodies that come towards each other along an axis and end within their thickness,
// where boxes, planes and the order in which pairs are queried decide before the pair itself is queried.
#include <gtest/gtest.h>

#include "tests/contact/close_bodies.hpp"

namespace bb::test::thick_bound_test {
namespace {

/// Two flat bodies over each other, across one axis, both of thickness, `gap` beyond it apart.
struct HeadOn {
  Scene scene;
  int second = 0, axis = 2;
  bool met = false;  // false: they pass by each other, or one of them overlaps itself
  std::vector<TruePair> pairs;
};

HeadOn head_on(Piece a, Piece b, double gap, unsigned seed, bool planar) {
  std::mt19937_64 rng(seed);
  HeadOn out;
  out.axis = static_cast<int>(rng() % (planar ? 2 : 3));
  out.scene.planar = planar;
  const double d_hat = between(rng, 0.01, 0.02);
  add_piece(out.scene, a, rng, d_hat, false);
  out.second = add_piece(out.scene, b, rng, d_hat, seed % 3 == 0);
  Positions& x = out.scene.x0;
  for (int v = 0; v < out.scene.n_vertices(); ++v) {
    out.scene.offset[at(v)] = d_hat * between(rng, 0.5, 3);
    if (!planar) x(out.axis, v) = 0;
  }
  if (seed % 2) x.colwise() += Vec3d(in_box(rng, 3, planar));
  out.scene.rest = x;
  x.row(out.axis).tail(x.cols() - out.second).array() += 5;
  for (const TruePair& p : TruePairs(out.scene).pairs) {
    if ((p.first[0] < out.second) != (p.second[0] < out.second)) out.pairs.push_back(p);
  }
  // lowered until the least gap of all is the wanted one: it may fall by no more than the way gone
  for (int k = 0; k < 100 && !out.pairs.empty(); ++k) {
    const double left = least_true_gap(out.scene, out.pairs, x) - gap;
    x.row(out.axis).tail(x.cols() - out.second).array() -= left;
    if (left > 1e-9) continue;
    // what overlaps in one body stops every motion
    out.met = least_true_gap(out.scene, TruePairs(out.scene).pairs, x) > gap / 2;
    break;
  }
  return out;
}

/// The second body comes down by `way`.
Positions lowered(const HeadOn& bodies, double way) {
  Positions x = bodies.scene.x0;
  x.row(bodies.axis).tail(x.cols() - bodies.second).array() -= way;
  return x;
}

/// The first of the times, to a thousandth of the motion, at which the least gap is not positive; 2: none.
double first_touch(const HeadOn& bodies, const Positions& x1) {
  const Positions& x0 = bodies.scene.x0;
  const auto gap = [&](double t) { return least_true_gap(bodies.scene, bodies.pairs, x0 + t * (x1 - x0)); };
  double last = 0;
  for (int k = 1; k <= 40; ++k) {
    const double t = k / 40.0;
    if (gap(t) > 0) {
      last = t;
      continue;
    }
    double high = t;
    for (int half = 0; half < 12; ++half) {
      const double middle = (last + high) / 2;
      (gap(middle) > 0 ? last : high) = middle;
    }
    return last;
  }
  return 2;
}

struct Tally {
  int stopped = 0, free = 0, in_thickness = 0;
};

double alpha_of(const Scene& scene, const Positions& x1, Precision precision) {
  ContactOptions options;
  options.precision = precision;
  ContactSystem contacts(scene, options);
  contacts.update_candidates(scene.x0, x1);
  return contacts.step_bound(scene.x0, x1).alpha;
}

void expect_stop(const HeadOn& bodies, double gap, double way, Tally& tally) {
  const Positions x1 = lowered(bodies, way);
  const double touch = first_touch(bodies, x1);
  for (const Precision precision : {Precision::full, Precision::single}) {
    const double alpha = alpha_of(bodies.scene, x1, precision);
    const double reached =
        least_true_gap(bodies.scene, bodies.pairs, bodies.scene.x0 + alpha * (x1 - bodies.scene.x0));
    ASSERT_GT(reached, 0) << "way " << way << " gap " << gap << " alpha " << alpha;
    ASSERT_EQ(alpha < 1, touch <= 1) << "way " << way << " gap " << gap << " alpha " << alpha;
    if (touch > 1) continue;
    EXPECT_LT(reached, 0.01 * gap + 1e-5) << "too timid";
  }
  ++(touch <= 1 ? tally.stopped : tally.free);
  // with half of the thickness nothing would be met
  double offset = std::numeric_limits<double>::infinity();
  for (const TruePair& p : bodies.pairs) offset = std::min(offset, p.offset);
  tally.in_thickness += touch <= 1 && way < gap + offset / 2;
}

TEST(ThickBound, StopsWhatEndsWithinTheThickness) {
  Tally tally;
  unsigned seed = 1;
  for (const bool planar : {false, true}) {
    for (const auto& [a, b] :
         {std::pair{Piece::edge, Piece::edge}, std::pair{Piece::triangle, Piece::point},
          std::pair{Piece::triangle, Piece::sheet}, std::pair{Piece::strip, Piece::point},
          std::pair{Piece::edge, Piece::triangle}}) {
      for (int k = 0; k < 12; ++k, ++seed) {
        const double gap = 1e-3 * (1 + seed % 5);
        const HeadOn bodies = head_on(a, b, gap, seed, planar);
        if (!bodies.met) continue;
        for (const double part : {-1.0, 0.9, 1.05, 2.0, 4.0}) expect_stop(bodies, gap, part * gap, tally);
      }
    }
  }
  EXPECT_GT(tally.stopped, 150);
  EXPECT_GT(tally.free, 100);
  EXPECT_GT(tally.in_thickness, 100);
}

/// The pair that stops the motion is queried even where boxes prove others to come a little later.
TEST(ThickBound, IsThatOfTheFirstOfManyThickPairs) {
  int of_several = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    std::mt19937_64 rng(seed);
    Scene all;
    double expected = 1;
    Positions x1(3, 0);
    for (unsigned k = 0; k < 5; ++k) {
      const bool edges = rng() % 2;
      const double gap = 1e-3 * between(rng, 0.9, 1.1);
      const HeadOn bodies = head_on(edges ? Piece::edge : Piece::triangle, edges ? Piece::edge : Piece::point,
                                    gap, seed * 10 + k, false);
      if (!bodies.met) continue;
      const Vec3d shift(40.0 * k, 0, 0);
      const Positions moved = lowered(bodies, 4e-3).colwise() + shift;
      append(all, bodies.scene, shift);
      x1.conservativeResize(3, x1.cols() + moved.cols());
      x1.rightCols(moved.cols()) = moved;
      const double touch = first_touch(bodies, lowered(bodies, 4e-3));
      expected = std::min(expected, touch);
    }
    const double alpha = alpha_of(all, x1, Precision::full);
    if (expected >= 1) continue;
    EXPECT_NEAR(alpha, expected, 2e-3 * expected + 1e-4) << seed;
    ++of_several;
  }
  EXPECT_GT(of_several, 30);
}

}  // namespace
}  // namespace bb::test::thick_bound_test
