// Films: places between frames, velocities, what is held before and after.
#include <gtest/gtest.h>

#include <cmath>

#include "core/model/scene/motion.hpp"

namespace bb::film_test {
namespace {

/// Frames of one vertex on the curve f, at times that are not in equal steps.
template <class F>
Film film_of(const F& f, FilmInterpolation between) {
  const std::vector<double> times = {0.1, 0.2, 0.35, 0.4, 0.6};
  std::vector<Positions> frames;
  for (const double t : times) {
    frames.emplace_back(3, 2);
    frames.back().col(0) = Vec3d(7, 7, 7);  // one that stays
    frames.back().col(1) = f(t);
  }
  return {times, frames, between};
}

Vec3d line(double t) { return {1 + 3 * t, -2 * t, 0.1}; }
Vec3d curve(double t) { return {std::sin(5 * t), std::cos(3 * t), t * t}; }

TEST(Film, IsHeldBeforeItsFirstFrameAndAfterItsLast) {
  for (const auto between : {FilmInterpolation::linear, FilmInterpolation::smooth}) {
    const Film film = film_of(curve, between);
    for (const double t : {-1.0, 0.0, 0.1}) EXPECT_EQ(film.at(1, t), curve(0.1));
    for (const double t : {0.6, 0.7, 99.0}) EXPECT_EQ(film.at(1, t), curve(0.6));
    EXPECT_EQ(film.velocity(1, 0.05), Vec3d(0, 0, 0));
    EXPECT_EQ(film.velocity(1, 0.6), Vec3d(0, 0, 0));
  }
}

TEST(Film, GoesThroughItsFrames) {
  for (const auto between : {FilmInterpolation::linear, FilmInterpolation::smooth}) {
    const Film film = film_of(curve, between);
    for (const double t : film.times()) EXPECT_LT((film.at(1, t) - curve(t)).norm(), 1e-15);
    for (double t = 0; t < 0.7; t += 0.01)
      EXPECT_EQ(film.at(0, t), Vec3d(7, 7, 7)) << "what stays stays to the bit";
  }
}

TEST(Film, IsExactForALineBetweenInnerFrames) {
  const Film linear = film_of(line, FilmInterpolation::linear),
             smooth = film_of(line, FilmInterpolation::smooth);
  for (double t = 0.2; t < 0.4; t += 0.007) {
    EXPECT_LT((linear.at(1, t) - line(t)).norm(), 1e-15);
    EXPECT_LT((smooth.at(1, t) - line(t)).norm(), 1e-15) << "tangents of a line are its slope";
  }
  EXPECT_LT((linear.at(1, 0.275) - line(0.275)).norm(), 1e-15);
}

TEST(Film, HasTheVelocityOfItsPlaces) {
  for (const auto between : {FilmInterpolation::linear, FilmInterpolation::smooth}) {
    const Film film = film_of(curve, between);
    for (const double t : {0.1, 0.15, 0.2, 0.3, 0.38, 0.59}) {
      const double h = 1e-7;
      const Vec3d slope = (film.at(1, t + h) - film.at(1, t)) / h;
      if (t > 0.1) {  // a smooth one begins at rest
        EXPECT_GT(slope.norm(), 0.1) << t;
      }
      EXPECT_LT((film.velocity(1, t) - slope).norm(), 1e-4) << t;
    }
  }
}

TEST(Film, SmoothOnesHaveNoJumpOfTheVelocityWhereLinearOnesHave) {
  const Film linear = film_of(curve, FilmInterpolation::linear),
             smooth = film_of(curve, FilmInterpolation::smooth);
  const double h = 1e-9;
  for (const double t : {0.1, 0.2, 0.35, 0.4, 0.6}) {
    EXPECT_LT((smooth.velocity(1, t + h) - smooth.velocity(1, t - h)).norm(), 1e-5) << t;
    EXPECT_GT((linear.velocity(1, t + h) - linear.velocity(1, t - h)).norm(), 0.1) << t;
  }
}

TEST(Film, IsTheFirstOfTheOperationsOfAMotion) {
  PrescribedMotion motion;
  motion.film = std::make_shared<const Film>(film_of(line, FilmInterpolation::linear));
  motion.first_vertex = 10;
  motion.velocity = Vec3d(0, 0, 2);
  EXPECT_FALSE(motion.is_static());
  EXPECT_TRUE(motion.changes_size());
  const Vec3d start = line(0.1);
  EXPECT_LT((motion.pose(11, start, 0.3) - line(0.3) - Vec3d(0, 0, 0.6)).norm(), 1e-15);
  EXPECT_EQ(motion.start_velocity(11, start), Vec3d(0, 0, 2));
  motion.translate(Vec3d(5, 0, 0));
  EXPECT_LT((motion.pose(11, start, 0.3) - line(0.3) - Vec3d(5, 0, 0.6)).norm(), 1e-14);
  PrescribedMotion other = motion;
  EXPECT_TRUE(same_motion(motion, other));
  other.first_vertex = 12;
  EXPECT_FALSE(same_motion(motion, other)) << "another body of the same film";
}

TEST(Film, RefusesOneFrame) {
  EXPECT_THROW(Film({0}, {Positions(3, 1)}, FilmInterpolation::linear), std::logic_error);
  EXPECT_THROW(Film({0, 1}, {Positions(3, 1), Positions(3, 2)}, FilmInterpolation::linear), std::logic_error);
}

}  // namespace
}  // namespace bb::film_test
