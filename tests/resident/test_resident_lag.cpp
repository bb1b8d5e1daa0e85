// Energies of the motion of contacts, friction and restitution, on an executor against the functions of core/energy row by row:
// coefficients and loads of the rows, gradient, matrix, motion of given vertices.
#include <gtest/gtest.h>

#include <optional>

#include "core/contact/contact_loads.hpp"
#include "core/exec/sums/resident_sum.hpp"
#include "core/resident/contact/resident_lag.hpp"
#include "tests/resident/assembled.hpp"

namespace bb::resident_lag_test {
namespace {

using namespace bb::test;
using resident::DampingRows;
using resident::LagView;
using resident::ResidentLag;
using resident::RubbingRows;

constexpr double eps_m = 2e-3;

/// Of the bodies and obstacles of full_scene().
std::vector<double> coefficients(std::size_t n, double first) {
  std::vector<double> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(i == 1 ? 0 : first + 0.1 * static_cast<double>(i));
  return out;
}

struct Sides {
  CombineRule rule;
  std::vector<double> of_body, of_obstacle;
  explicit Sides(const Scene& scene, CombineRule of)
      : rule(of),
        of_body(coefficients(scene.bodies.size(), 0.2)),
        of_obstacle(coefficients(scene.obstacles.size(), 0.35)) {}
};

/// The rows of the host at x, with loads, and how strong each is.
struct HostLag {
  ContactLoads contacts;
  std::vector<double> strength;
  HostLag(const Scene& scene, const Positions& x, const Sides& sides) {
    ContactSystem system(scene, {});
    Rows rows = rows_at(system, x);
    evaluate_cubic(rows.table);
    evaluate_cubic(rows.mollified);
    add_loads(rows.table, contacts);
    add_loads(rows.mollified, x, contacts);
    for (std::size_t r = 0; r < contacts.size(); ++r) {
      const int* const vertex = &contacts.stencil[4 * r];
      int last = 3;
      while (vertex[last] < 0) --last;
      const auto of_body = [&](int v) { return sides.of_body[at(scene.body[at(v)])]; };
      const double other =
          contacts.obstacle[r] >= 0 ? sides.of_obstacle[at(contacts.obstacle[r])] : of_body(vertex[last]);
      strength.push_back(combined(sides.rule, of_body(vertex[0]), other) * contacts.load[r]);
    }
  }
  Vec3d relative(std::size_t r, const Positions& motion) const {
    Vec3d out = Vec3d::Zero();
    for (std::size_t k = 4 * r; k < 4 * r + 4 && contacts.stencil[k] >= 0; ++k)
      out += contacts.weight[k] * motion.col(contacts.stencil[k]);
    return out;
  }
  Vec3d normal(std::size_t r) const { return Vec3d::Map(&contacts.normal[3 * r]); }
};

struct Sums {
  double energy = 0;
  VecXd gradient, force;
  Matrix matrix;
};

/// terms(lag, r, motion): MotionTerms.
template <class Terms>
Sums sums_of(const HostLag& lag, const Scene& scene, const Positions& way, const Positions& given,
             const Terms& terms) {
  const auto n = 3 * scene.n_vertices();
  const Surface surface(scene);
  Sums out{0, VecXd::Zero(n), VecXd::Zero(n), Matrix::Zero(n, n)};
  for (std::size_t r = 0; r < lag.contacts.size(); ++r) {
    const MotionTerms<double> of = terms(lag, r, lag.relative(r, way));
    out.energy += of.energy;
    const Vec3d moved = of.hess * lag.relative(r, given);
    for (std::size_t i = 4 * r; i < 4 * r + 4; ++i) {
      const int vi = lag.contacts.stencil[i];
      if (vi < 0 || surface.vertex_free[at(vi)] == 0) continue;
      out.gradient.segment<3>(3 * vi) += lag.contacts.weight[i] * of.grad;
      out.force.segment<3>(3 * vi) += lag.contacts.weight[i] * moved;
      for (std::size_t j = 4 * r; j < 4 * r + 4; ++j) {
        const int vj = lag.contacts.stencil[j];
        if (vj < 0 || surface.vertex_free[at(vj)] == 0) continue;
        out.matrix.block<3, 3>(3 * vi, 3 * vj) += lag.contacts.weight[i] * lag.contacts.weight[j] * of.hess;
      }
    }
  }
  return out;
}

/// A lag of an executor, and what it sums up.
struct OnLag {
  OnExecutor on;
  ContactAssembly assembly;
  ResidentLag lag;
  exec::Buffer<double> x_n, y, moved, energy, force, hess, gradient, given;

  OnLag(exec::Executor& executor, const Scene& scene, const Positions& x, const Sides& sides)
      : on(executor, scene, x),
        assembly(executor, on.resident, scene.n_vertices()),
        lag(executor, on.resident, scene.n_vertices(), sides.rule, sides.of_body, sides.of_obstacle),
        x_n(executor, "start"),
        y(executor, "state"),
        moved(executor, "motion"),
        energy(executor, "energy"),
        force(executor, "force"),
        hess(executor, "hess"),
        gradient(executor, "gradient", 3 * scene.n_vertices()),
        given(executor, "given", 3 * scene.n_vertices()) {
    on.rows.uniform_kappa = kappa;
    ResidentBarrier(cubic(), false).evaluate(executor, on.rows);
    upload(x_n, x);
    lag.take(on.rows);
    EXPECT_FALSE(lag.known());
    lag.learn(assembly.row_energy(on.rows, on.x));
    EXPECT_TRUE(lag.known());
  }
  template <class Rows>
  Sums sums(exec::Executor& executor, Rows rows, const Positions& to, const Positions& motion) {
    static_cast<LagView&>(rows) = lag.view(x_n.data());
    upload(y, to), upload(moved, motion);
    const Index n = lag.size();
    energy.resize(n), force.resize(3 * n), hess.resize(6 * n);
    gradient.fill_zero(), given.fill_zero();
    executor.each(n, resident::MotionGradients<Rows>{rows, y.data(), energy.data(), force.data()});
    lag.add_forces(force.data(), gradient);
    const std::vector<double> energies = energy.download();
    executor.each(n, resident::MotionValues<Rows>{rows, y.data(), energy.data()});
    EXPECT_EQ(energy.download(), energies);
    executor.each(n, resident::MotionChanges<Rows>{rows, y.data(), moved.data(), force.data()});
    lag.add_forces(force.data(), given);
    executor.each(n, resident::MotionHessians<Rows>{rows, y.data(), hess.data()});
    const MatrixPart part = lag.matrix(hess.data());
    const int n_vertices = static_cast<int>(gradient.size() / 3);
    Sums out{0, VecXd::Map(gradient.data(), gradient.size()), VecXd::Map(given.data(), given.size()),
             dense(part, n_vertices)};
    for (const double e : energies) out.energy += e;
    return out;
  }
};

void expect_same(const Sums& found, const Sums& expected) {
  ASSERT_GT(expected.energy, 1e-6);
  ASSERT_GT(expected.gradient.norm(), 1e-3);
  ASSERT_GT(expected.force.norm(), 1e-3);
  ASSERT_GT(expected.matrix.norm(), 1);
  EXPECT_NEAR(found.energy, expected.energy, 1e-12 * expected.energy);
  EXPECT_LT((found.gradient - expected.gradient).norm(), 1e-12 * expected.gradient.norm());
  EXPECT_LT((found.force - expected.force).norm(), 1e-12 * expected.force.norm());
  EXPECT_LT((found.matrix - expected.matrix).norm(), 1e-12 * expected.matrix.norm());
}

template <class Law>
void expect_friction(const Scene& scene, CombineRule rule, unsigned seed) {
  const Positions x = shaken(scene), y = random_motion(x, 0.7 * eps_m, seed), given = motion_of_given(scene);
  const Sides sides(scene, rule);
  const HostLag host(scene, x, sides);
  const LawWithEps<Law, double> law{eps_m};
  std::size_t slides = 0, sticks = 0, mollified = 0;
  double work = 0;
  const Sums expected =
      sums_of(host, scene, y - x, given, [&](const HostLag& lag, std::size_t r, const Vec3d& way) {
        const Vec3d slide = slide_of<double>(way, lag.normal(r));
        if (lag.strength[r] > 0) ++(slide.norm() < eps_m ? sticks : slides);
        work += friction_work(slide.norm(), lag.strength[r], law);
        return friction_of_slide<double>(slide, lag.normal(r), lag.strength[r], law);
      });
  ASSERT_GT(slides, 10u);
  ASSERT_GT(sticks, 10u);
  TestedExecutor executor;
  OnLag on(executor, scene, x, sides);
  mollified = static_cast<std::size_t>(on.on.rows.list.size());
  ASSERT_GT(mollified, 0u);
  ASSERT_EQ(static_cast<std::size_t>(on.lag.size()), host.contacts.size());
  RubbingRows<Law> rows{};
  rows.eps = eps_m;
  expect_same(on.sums(executor, rows, y, given), expected);
  resident::ResidentSums<resident::FrictionNumbers> numbers(executor);
  static_cast<LagView&>(rows) = on.lag.view(on.x_n.data());
  numbers.add(on.lag.size(), resident::FrictionOfRows<Law>{rows, on.y.data()});
  const resident::FrictionNumbers said = numbers.get();
  EXPECT_EQ(said.sliding, slides);
  EXPECT_EQ(said.sticking, sticks);
  EXPECT_NEAR(said.work.value(), work, 1e-12 * work);
}

TEST(ResidentLag, HasTheFrictionOfTheRows) {
  for (const CombineRule rule : {CombineRule::min, CombineRule::max, CombineRule::mean}) {
    SCOPED_TRACE(static_cast<int>(rule));
    expect_friction<friction_laws::smoothed_coulomb>(full_scene(3), rule, 8);
    expect_friction<friction_laws::capped>(full_scene(3), rule, 9);
  }
}

TEST(ResidentLag, HasTheRestitutionOfTheRows) {
  const Scene scene = full_scene(3);
  const Positions x = shaken(scene), y = random_motion(x, eps_m, 5), given = motion_of_given(scene);
  const Sides sides(scene, CombineRule::max);
  const HostLag host(scene, x, sides);
  constexpr double dt = 5e-5;  // so short that contacts that open yield
  double work = 0;
  std::size_t damps = 0, yields = 0;
  const Sums expected =
      sums_of(host, scene, y - x, given, [&](const HostLag& lag, std::size_t r, const Vec3d& way) {
        const ContactDamping<double> damping{lag.strength[r] / dt, lag.contacts.load[r]};
        const double opening = way.dot(lag.normal(r));
        ++(damping.force(opening) < damping.load ? damps : yields);
        work += damping.force(opening) * opening;
        return damping_terms<double>(way, lag.normal(r), damping);
      });
  ASSERT_GT(damps, 10u);
  ASSERT_GT(yields, 10u);
  TestedExecutor executor;
  OnLag on(executor, scene, x, sides);
  DampingRows rows{};
  rows.dt = dt;
  expect_same(on.sums(executor, rows, y, given), expected);
  resident::ResidentSum sum(executor);
  static_cast<LagView&>(rows) = on.lag.view(on.x_n.data());
  sum.add(on.lag.size(), resident::DampingOfRows{rows, on.y.data()});
  EXPECT_NEAR(sum.get().value(), work, 1e-12 * work);
}

// Pairs that were there keep the speed at which they met.
TEST(ResidentLag, RemembersHowFastPairsMet) {
  const Scene scene = full_scene(3);
  const Positions x = shaken(scene), speed = random_motion(Positions::Zero(3, x.cols()), 0.5, 4);
  TestedExecutor executor;
  OnLag on(executor, scene, x, Sides(scene, CombineRule::max));
  const Index n = on.lag.size();
  const std::vector<Key> pairs = on.lag.on_host().pair;
  std::vector<Key> known;
  std::vector<double> known_speed;
  for (std::size_t r = 0; r < pairs.size(); r += 3)
    known.push_back(pairs[r]), known_speed.push_back(7 + static_cast<double>(r));
  exec::Buffer<Key> pair(executor, "known");
  exec::Buffer<double> known_there(executor, "known speed"), v(executor, "speed"), met(executor, "met", n);
  pair.upload(known), known_there.upload(known_speed), upload(v, speed);
  const LagView view = on.lag.view(on.x_n.data());
  executor.each(
      n, resident::RememberMeeting{
             view, on.lag.pairs(), {pair.data(), known_there.data(), pair.size()}, v.data(), met.data()});
  const std::vector<double> found = met.download();
  const ResidentLag::Columns rows = on.lag.on_host();
  double largest = 0;
  for (std::size_t r = 0; r < found.size(); ++r) {
    double closing = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const int vertex = rows.vertex[k * found.size() + r];
      if (vertex < 0) continue;
      for (std::size_t c = 0; c < 3; ++c)
        closing -= rows.weight[k * found.size() + r] * speed(static_cast<int>(c), vertex) *
                   rows.normal[c * found.size() + r];
    }
    largest = std::max(largest, std::abs(closing));
    EXPECT_NEAR(found[r], r % 3 == 0 ? 7 + static_cast<double>(r) : closing, 1e-12);
  }
  ASSERT_GT(largest, 0.1);
  exec::Buffer<double> strength(executor, "strength");
  strength.upload(std::vector<double>(found.size(), 3.0));
  executor.each(n, resident::DampByMeeting{met.data(), 0.2, strength.data()});
  const std::vector<double> damped = strength.download();
  for (std::size_t r = 0; r < found.size(); ++r) EXPECT_DOUBLE_EQ(damped[r], 3 / std::max(found[r], 0.2));
}

/// Every obstacle stands at a given vertex of its own.
Scene with_vertices_of_obstacles(Scene scene) {
  for (Obstacle& o : scene.obstacles) {
    o.vertex = scene.n_vertices();
    scene.rest.conservativeResize(3, o.vertex + 1);
    scene.rest.col(o.vertex) = o.point;
    scene.mass.push_back(0);
    scene.body.push_back(0);
    scene.d_hat.push_back(0.08);
    scene.offset.push_back(0);
    scene.pins.push_back({o.vertex, 0});
  }
  scene.x0 = scene.rest;
  return scene;
}

Mat3d turned(double angle) { return Eigen::AngleAxisd(angle, Vec3d(2, 1, -2) / 3.0).toRotationMatrix(); }

// What the turn of an obstacle takes along is where its surface is nearest: the gap away from the other side, along the normal.
TEST(ResidentLag, FollowsTheSurfaceOfObstaclesThatTurn) {
  const Scene scene = with_vertices_of_obstacles(full_scene(3));
  const Positions x = shaken(scene);
  TestedExecutor executor;
  OnLag on(executor, scene, x, Sides(scene, CombineRule::max));
  std::vector<resident::ObstacleTurn> turns;
  for (std::size_t o = 0; o < scene.obstacles.size(); ++o) {
    resident::ObstacleTurn& turn = turns.emplace_back();
    turn.turns = o != 2;
    Mat3d::Map(turn.lag) = turned(0.1 + static_cast<double>(o));
    Mat3d::Map(turn.begin) = turned(0.3);
    Mat3d::Map(turn.end) = turned(0.7);
  }
  exec::Buffer<resident::ObstacleTurn> there(executor, "turns");
  there.upload(turns);
  const Index n = on.lag.size();
  exec::Buffer<double> spin(executor, "spin", 3 * n);
  executor.each(
      n, resident::FindSpins{on.lag.view(on.x_n.data()), on.lag.pairs(), on.on.resident.view().obstacles,
                             there.data(), on.x_n.data(), spin.data()});
  const std::vector<double> found = spin.download();
  const resident::RowView rows = on.on.rows.view();
  std::vector<int> seen(scene.obstacles.size(), 0);
  for (Index r = 0; r < n; ++r) {
    const Vec3d way(found[at(static_cast<int>(r))], found[at(static_cast<int>(n + r))],
                    found[at(static_cast<int>(2 * n + r))]);
    const int o = pair_obstacle(rows.pair[r]);
    if (o < 0 || o == 2) {
      EXPECT_EQ(way, Vec3d(0, 0, 0));
      continue;
    }
    if (scene.body[at(rows.vertex[r])] == 1 || rows.mollified(r)) continue;  // with a thickness
    Vec3d side = Vec3d::Zero();
    for (int k = 0; k < 4; ++k) {
      const int v = rows.vertex[k * n + r];
      if (v >= 0 && v != scene.obstacles[at(o)].vertex) side += rows.weight[k * n + r] * x.col(v);
    }
    const Vec3d arm = side - rows.d[r] * rows.normal_of(r) - x.col(scene.obstacles[at(o)].vertex);
    const Mat3d back = turned(-0.1 - o);
    const Vec3d expected = (turned(0.7) - turned(0.3)) * (back * arm);
    EXPECT_LT((way - expected).norm(), 1e-12 * (1 + arm.norm()));
    seen[at(o)] += way.norm() > 1e-3;
  }
  for (const std::size_t o : {1, 3, 4}) EXPECT_GT(seen[o], 0) << o;
}

TEST(ResidentLag, HasTheSameBitsInEveryOrder) {
  const Scene scene = full_scene(5);
  const Positions x = shaken(scene), y = random_motion(x, eps_m, 6), given = motion_of_given(scene);
  const Sides sides(scene, CombineRule::mean);
  std::optional<Sums> first;
  for (const exec::Order order : all_orders) {
    TestedExecutor executor(order, 5);
    OnLag on(executor, scene, x, sides);
    RubbingRows<friction_laws::smoothed_coulomb> rows{};
    rows.eps = eps_m;
    const Sums found = on.sums(executor, rows, y, given);
    if (!first) first = found;
    EXPECT_EQ(found.gradient, first->gradient);
    EXPECT_EQ(found.matrix, first->matrix);
    EXPECT_EQ(found.force, first->force);
    EXPECT_EQ(found.energy, first->energy);
  }
}

}  // namespace
}  // namespace bb::resident_lag_test
