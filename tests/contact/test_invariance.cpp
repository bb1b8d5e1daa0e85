// Step bound and rows do not depend on where a scene is, how it is turned, in which unit it is written down, in which
// order its bodies and vertices come, or on a body that is far away.
#include <gtest/gtest.h>

#include <numeric>

#include "tests/contact/close_bodies.hpp"

namespace bb::test::invariance_test {
namespace {

/// A scene, a motion of it, and what is found: alpha, all gaps with their numbers, B.
struct Subject {
  Scene scene;
  Positions x1;
};
struct Found {
  double alpha, energy, min_gap;
  std::vector<double> gaps;  // of all pairs, ascending
  ContactKey key;
  ContactKind kind;
};

Found look(const Subject& s) {
  ContactSystem contacts(s.scene, {});
  contacts.update_candidates(s.scene.x0, s.x1);
  const StepBound bound = contacts.step_bound(s.scene.x0, s.x1);
  const Rows rows = rows_at(contacts, s.scene.x0);
  Found out{bound.alpha, barrier(contacts, s.scene.x0, 1.0, TestShape::cubic), rows.min_gap, {}, bound.key,
            bound.kind};
  out.gaps = rows.table.d;
  out.gaps.insert(out.gaps.end(), rows.mollified.d.begin(), rows.mollified.d.end());
  std::sort(out.gaps.begin(), out.gaps.end());
  return out;
}

Subject subject(unsigned seed) {
  Subject out{mixed_scene(seed, seed % 4 == 0, seed % 3 ? 1 : 20), {}};
  const double size = seed % 5 == 0 ? 1.0 : 0.02;
  out.x1 = random_motion(out.scene.x0, size, seed);
  if (out.scene.planar) out.x1.row(2).setZero();
  return out;
}

/// Calls f(subject, what is found of it) and asserts that subjects have contacts and are bounded often enough.
template <class F>
void for_each_subject(const F& f) {
  std::size_t contacts = 0;
  int bounded = 0, n = 0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const Subject s = subject(seed);
    const Found found = look(s);
    if (!(found.min_gap > 0)) continue;  // two pieces of one body at random touch at times
    contacts += found.gaps.size();
    bounded += found.alpha < 1;
    ++n;
    f(s, found);
  }
  EXPECT_GT(n, 40);
  EXPECT_GT(contacts, 1000U);
  EXPECT_GT(bounded, 25);
}

void expect_same(const Found& a, const Found& b, double tolerance) {
  // a slow motion of a long way comes to the stop level at a time that knows its rounding
  EXPECT_NEAR(a.alpha, b.alpha, 1e2 * tolerance);
  EXPECT_NEAR(a.energy, b.energy, 1e2 * tolerance);
  ASSERT_EQ(a.gaps.size(), b.gaps.size());
  for (std::size_t i = 0; i < a.gaps.size(); ++i) EXPECT_NEAR(a.gaps[i], b.gaps[i], tolerance);
}

TEST(Invariance, UnderTranslation) {
  for_each_subject([](const Subject& s, const Found& found) {
    Subject moved = s;
    const Vec3d shift = s.scene.planar ? Vec3d(-32, 8, 0) : Vec3d(-32, 8, 16);
    for (Positions* x : {&moved.scene.rest, &moved.scene.x0, &moved.x1}) x->colwise() += shift;
    for (Obstacle& o : moved.scene.obstacles) o.point += shift;
    expect_same(look(moved), found, 1e-12);
  });
}

TEST(Invariance, UnderRotation) {
  for_each_subject([](const Subject& s, const Found& found) {
    Subject turned = s;
    const Vec3d axis = s.scene.planar ? Vec3d(Vec3d::UnitZ()) : Vec3d(1, -2, 2) / 3.0;
    const Mat3d r = Eigen::AngleAxisd(0.7, axis).toRotationMatrix();
    for (Positions* x : {&turned.scene.rest, &turned.scene.x0, &turned.x1}) *x = (r * *x).eval();
    for (Obstacle& o : turned.scene.obstacles) {
      o.point = r * o.point;
      o.axis = (r * o.axis).normalized();
    }
    expect_same(look(turned), found, 1e-12);
  });
}

/// A power of two is exact: every number has the same bits but for its exponent.
TEST(Invariance, UnderAChangeOfTheUnitOfLengthToTheBit) {
  for_each_subject([](const Subject& s, const Found& found) {
    for (const double unit : {0x1p-20, 0x1p20}) {
      Subject other = s;
      for (Positions* x : {&other.scene.rest, &other.scene.x0, &other.x1}) *x *= unit;
      for (std::vector<double>* column : {&other.scene.d_hat, &other.scene.offset}) {
        for (double& value : *column) value *= unit;
      }
      for (Obstacle& o : other.scene.obstacles) o.point *= unit, o.radius *= unit;
      const Found there = look(other);
      EXPECT_EQ(there.alpha, found.alpha);
      EXPECT_EQ(there.key, found.key);
      EXPECT_EQ(there.kind, found.kind);
      EXPECT_EQ(there.energy, found.energy * unit * unit);
      ASSERT_EQ(there.gaps.size(), found.gaps.size());
      for (std::size_t i = 0; i < found.gaps.size(); ++i) EXPECT_EQ(there.gaps[i], found.gaps[i] * unit);
    }
  });
}

/// The same scene with vertex v called to[v]; bodies keep their vertices, which need not be in a row.
Subject renamed(const Subject& s, const std::vector<int>& to) {
  Subject out = s;
  const auto rename = [&to](auto& lists) {
    for (auto& list : lists) {
      for (int& v : list) v = to[at(v)];
    }
  };
  for (int v = 0; v < s.scene.n_vertices(); ++v) {
    const int w = to[at(v)];
    out.scene.rest.col(w) = s.scene.rest.col(v);
    out.scene.x0.col(w) = s.scene.x0.col(v);
    out.x1.col(w) = s.x1.col(v);
    out.scene.body[at(w)] = s.scene.body[at(v)];
    out.scene.d_hat[at(w)] = s.scene.d_hat[at(v)];
    out.scene.offset[at(w)] = s.scene.offset[at(v)];
  }
  rename(out.scene.surface_edges);
  rename(out.scene.surface_triangles);
  if (!out.scene.membranes.empty()) rename(out.scene.membranes[0].triangles);
  for (int& v : out.scene.surface_vertices) v = to[at(v)];
  for (Pin& pin : out.scene.pins) pin.vertex = to[at(pin.vertex)];
  for (Body& body : out.scene.bodies) body = {body.name, 0, s.scene.n_vertices()};
  return out;
}

TEST(Invariance, UnderTheOrderOfVerticesAndOfThePrimitivesAndTheirCorners) {
  unsigned seed = 1;
  for_each_subject([&seed](const Subject& s, const Found& found) {
    std::mt19937_64 rng(++seed);
    std::vector<int> to(at(s.scene.n_vertices()));
    std::iota(to.begin(), to.end(), 0);
    std::shuffle(to.begin(), to.end(), rng);
    Subject other = renamed(s, to);
    for (auto& t : other.scene.surface_triangles) std::rotate(t.begin(), t.begin() + rng() % 3, t.end());
    for (auto& e : other.scene.surface_edges) {
      if (rng() % 2) std::swap(e[0], e[1]);
    }
    std::shuffle(other.scene.surface_triangles.begin(), other.scene.surface_triangles.end(), rng);
    std::shuffle(other.scene.surface_edges.begin(), other.scene.surface_edges.end(), rng);
    std::shuffle(other.scene.surface_vertices.begin(), other.scene.surface_vertices.end(), rng);
    expect_same(look(other), found, 1e-12);
  });
}

/// Bodies from the last to the first, each with its vertices in their order.
TEST(Invariance, UnderTheOrderOfBodies) {
  for_each_subject([](const Subject& s, const Found& found) {
    std::vector<int> to(at(s.scene.n_vertices()));
    int next = 0;
    for (std::size_t b = s.scene.bodies.size(); b-- > 0;) {
      for (int v = 0; v < s.scene.n_vertices(); ++v) {
        if (s.scene.body[at(v)] == static_cast<int>(b)) to[at(v)] = next++;
      }
    }
    expect_same(look(renamed(s, to)), found, 1e-12);
  });
}

TEST(Invariance, UnderAFarBodyToTheBit) {
  for_each_subject([](const Subject& s, const Found& found) {
    if (s.scene.planar) return;
    for (const double distance : {1e3, 1e7}) {
      Subject beside = s;
      std::mt19937_64 rng(9);
      const Vec3d far = distance * Vec3d(0.3, -0.8, 0.5);
      const int n = 3;
      add_body(beside.scene, "far", {far, far + in_box(rng, 1), far + in_box(rng, 1)}, {{0, 1, 2}}, 0.01);
      beside.scene.x0.leftCols(s.scene.x0.cols()) = s.scene.x0;
      beside.x1 = beside.scene.x0;
      beside.x1.leftCols(s.x1.cols()) = s.x1;
      beside.x1.rightCols(n).array() += 0.25;
      const Found there = look(beside);
      EXPECT_EQ(there.alpha, found.alpha);
      EXPECT_EQ(there.key, found.key);
      EXPECT_EQ(there.gaps, found.gaps);
      EXPECT_EQ(there.energy, found.energy);
    }
  });
}

/// More than the unit: a motion that is run through twice as fast is stopped at half the time, for powers of two to the
/// bit as long as it stays a motion of the same pairs.
TEST(Invariance, UnderALongerMotionTheStateThatStopsIsTheSame) {
  int bounded = 0;
  for_each_subject([&bounded](const Subject& s, const Found& found) {
    if (!(found.alpha < 1)) return;
    Subject longer = s;
    longer.x1 = s.scene.x0 + 2 * (s.x1 - s.scene.x0);
    const double alpha = look(longer).alpha;
    EXPECT_NEAR(2 * alpha, found.alpha, 1e-9);
    ++bounded;
  });
  EXPECT_GT(bounded, 25);
}

}  // namespace
}  // namespace bb::test::invariance_test
