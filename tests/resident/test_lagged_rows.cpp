// Families of rows on lagged contacts, friction and restitution, on an executor against the functions of core/energy row by row:
// coefficients and loads of the rows, gradient, matrix, motion of given vertices; and against their form for the CPU path bit by bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>

#include "core/base/archive/archive.hpp"
#include "core/contact/contact_loads.hpp"
#include "core/energy/friction_law.hpp"
#include "core/energy/friction_list.hpp"
#include "core/exec/sums/resident_sum.hpp"
#include "core/resident/contact/lagged_assembly.hpp"
#include "core/terms/friction_rows.hpp"
#include "core/terms/lagged_family.hpp"
#include "core/terms/restitution_rows.hpp"
#include "tests/resident/assembled.hpp"

namespace bb::lagged_rows_test {
namespace {

using namespace bb::test;
using resident::LaggedAssembly;

constexpr double eps_m = 2e-3;

constexpr double dt = 0.01;  // s

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
template <class Side>
void set_friction(std::vector<Side>& sides, const std::vector<double>& mu) {
  for (std::size_t i = 0; i < sides.size(); ++i) sides[i].friction = mu[i];
}
/// full_scene() whose bodies and obstacles have these coefficients of friction.
Scene with_friction(Scene scene, const Sides& sides) {
  set_friction(scene.bodies, sides.of_body);
  set_friction(scene.obstacles, sides.of_obstacle);
  return scene;
}
/// The same with restitution, and with speeds.
Scene with_restitution(Scene scene) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    scene.bodies[i].restitution = 0.3 + 0.1 * static_cast<double>(i);
  scene.obstacles[0].restitution = 0.9;
  scene.v0 = random_motion(Positions::Zero(3, scene.n_vertices()), 0.5, 4);
  return scene;
}
Sides restitution_sides(const Scene& scene) {
  Sides out(scene, CombineRule::max);
  const auto of = [](const auto& side) { return restitution_damping(side.restitution.value_or(1)); };
  std::transform(scene.bodies.begin(), scene.bodies.end(), out.of_body.begin(), of);
  std::transform(scene.obstacles.begin(), scene.obstacles.end(), out.of_obstacle.begin(), of);
  return out;
}
FrictionOptions friction_options(const std::string& law, CombineRule rule) {
  FrictionOptions out;
  out.law = law;
  out.combine = rule;
  out.eps_v = eps_m / dt;
  return out;
}

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
      const int obstacle = pair_obstacle(contacts.pair[r]);
      const double other = obstacle >= 0 ? sides.of_obstacle[at(obstacle)] : of_body(vertex[last]);
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

/// A family on an executor with the rows at x, from where a step begins, and what it sums up.
struct OnRows {
  using Family = std::unique_ptr<LaggedFamily>;
  OnExecutor on;
  ContactAssembly contact;
  Family family;
  LaggedAssembly assembly;
  exec::Buffer<double> x_n, y, moved, energy, force, hess, gradient, given;

  /// make(body): the family.
  template <class Make>
  OnRows(exec::Executor& executor, const Scene& scene, const Positions& x, double length, const Make& make)
      : on(executor, scene, x),
        contact(executor, on.resident, scene.n_vertices()),
        family(make(on.resident.view().body)),
        assembly(executor, family->rows(), scene.n_vertices()),
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
    FamilyStep step;
    step.x_n = step.x_tilde = x_n.data();
    step.dt = step.t_end = length;
    family->begin_step(step);
    take();
  }
  void take() {
    assembly.take(on.rows);
    family->take(x_n.data(), x_n.size());
    EXPECT_FALSE(family->loads_known());
    assembly.learn(contact.row_energy(on.rows, on.x));
    family->know_loads();
    EXPECT_TRUE(family->loads_known());
  }
  Sums sums(const Positions& to, const Positions& motion) {
    upload(y, to), upload(moved, motion);
    const Index n = family->size();
    energy.resize(n), force.resize(3 * n), hess.resize(6 * n);
    gradient.fill_zero(), given.fill_zero();
    family->changes(y.data(), moved.data(), force.data());
    assembly.add_forces(force.data(), given);
    family->gradients(y.data(), energy.data(), force.data());
    assembly.add_forces(force.data(), gradient);
    const std::vector<double> energies = energy.download();
    family->values(y.data(), energy.data());
    EXPECT_EQ(energy.download(), energies);
    family->hessians(y.data(), hess.data());
    const MatrixPart part = assembly.matrix(hess.data());
    const int n_vertices = static_cast<int>(gradient.size() / 3);
    Sums out{0, VecXd::Map(gradient.data(), gradient.size()), VecXd::Map(given.data(), given.size()),
             dense(part, n_vertices)};
    for (const double e : energies) out.energy += e;
    return out;
  }
};
OnRows friction_on(exec::Executor& executor, const Scene& scene, const Positions& x,
                   const FrictionOptions& options) {
  return {executor, scene, x, dt, [&](const int* body) {
            TermOptions all;
            all.friction = options;
            return friction_family({executor}, scene, all, body);
          }};
}
OnRows restitution_on(exec::Executor& executor, const Scene& scene, const Positions& x, double length) {
  return {executor, scene, x, length,
          [&](const int* body) { return restitution_family({executor}, scene, {}, body); }};
}

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
void expect_friction(const std::string& law_name, CombineRule rule, unsigned seed) {
  const Sides sides(full_scene(3), rule);
  const Scene scene = with_friction(full_scene(3), sides);
  const Positions x = shaken(scene), y = random_motion(x, 0.7 * eps_m, seed), given = motion_of_given(scene);
  const HostLag host(scene, x, sides);
  const LawWithEps<Law, double> law{eps_m};
  int slides = 0, sticks = 0;
  double work = 0;
  const Sums expected =
      sums_of(host, scene, y - x, given, [&](const HostLag& lag, std::size_t r, const Vec3d& way) {
        const Vec3d slide = slide_of<double>(way, lag.normal(r));
        if (lag.strength[r] > 0) ++(slide.norm() < eps_m ? sticks : slides);
        work += friction_work(slide.norm(), lag.strength[r], law);
        return friction_of_slide<double>(slide, lag.normal(r), lag.strength[r], law);
      });
  ASSERT_GT(slides, 10);
  ASSERT_GT(sticks, 10);
  TestedExecutor executor;
  const FrictionOptions options = friction_options(law_name, rule);
  OnRows on = friction_on(executor, scene, x, options);
  ASSERT_GT(on.on.rows.list.size(), 0u);  // mollified ones
  ASSERT_EQ(static_cast<std::size_t>(on.family->size()), host.contacts.size());
  expect_same(on.sums(y, given), expected);
  StepNumbers said;
  on.family->report_end(on.y.data(), said);
  EXPECT_EQ(said.friction_sliding, slides);
  EXPECT_EQ(said.friction_sticking, sticks);
  EXPECT_NEAR(said.friction_dissipation_J.value, work, 1e-12 * work);
}

TEST(LaggedRows, HaveTheFrictionOfTheContacts) {
  for (const CombineRule rule : {CombineRule::min, CombineRule::max, CombineRule::mean}) {
    SCOPED_TRACE(static_cast<int>(rule));
    expect_friction<friction_laws::smoothed_coulomb>("smoothed_coulomb", rule, 8);
    expect_friction<friction_laws::capped>("capped", rule, 9);
  }
}

TEST(LaggedRows, HaveTheRestitutionOfTheContacts) {
  const Scene scene = with_restitution(full_scene(3));
  const Positions x = shaken(scene), y = random_motion(x, eps_m, 5), given = motion_of_given(scene);
  const HostLag host(scene, x, restitution_sides(scene));
  constexpr double length = 5e-5;  // s, so short that contacts that open yield
  double work = 0;
  std::size_t damps = 0, yields = 0, slow = 0;
  const Sums expected =
      sums_of(host, scene, y - x, given, [&](const HostLag& lag, std::size_t r, const Vec3d& way) {
        const double met = -lag.relative(r, scene.v0).dot(lag.normal(r));
        slow += met < 0.01;
        const double a = lag.strength[r] / std::max(met, 0.01);
        const ContactDamping<double> damping{a / length, lag.contacts.load[r]};
        const double opening = way.dot(lag.normal(r));
        ++(damping.force(opening) < damping.load ? damps : yields);
        work += damping.force(opening) * opening;
        return damping_terms<double>(way, lag.normal(r), damping);
      });
  ASSERT_GT(damps, 10u);
  ASSERT_GT(yields, 10u);
  ASSERT_GT(slow, 10u);
  ASSERT_LT(slow, host.contacts.size() - 10);
  TestedExecutor executor;
  OnRows on = restitution_on(executor, scene, x, length);
  expect_same(on.sums(y, given), expected);
  StepNumbers said;
  on.family->report_end(on.y.data(), said);
  EXPECT_NEAR(said.restitution_dissipation_J.value, work, 1e-12 * work);
}

// Pairs that were there keep the speed at which they met; the others meet with that of the step before.
TEST(LaggedRows, RememberHowFastPairsMet) {
  const Scene scene = with_restitution(full_scene(3));
  const Positions x = shaken(scene), end = random_motion(x, 5e-3, 7);
  TestedExecutor executor;
  OnRows on = restitution_on(executor, scene, x, dt);
  KnownLag some = on.family->known("restitution");
  const std::vector<PairId> all = some.pair;
  const std::vector<double> first = some.kept;
  some.pair.clear(), some.kept.clear();
  for (std::size_t r = 0; r < all.size(); r += 3)
    some.pair.push_back(all[r]), some.kept.push_back(7 + static_cast<double>(r));
  const std::size_t n = some.pair.size();
  some.vertex.assign(4 * n, 0), some.weight.assign(4 * n, 0), some.normal.assign(3 * n, 0);
  some.load.assign(n, 0), some.strength.assign(n, 0);
  on.family->adopt(some);
  upload(on.y, end);
  on.family->end_step(on.y.data());
  on.take();
  const KnownLag found = on.family->known("restitution");
  const HostLag host(scene, x, restitution_sides(scene));
  ASSERT_EQ(found.pair, all);
  std::map<PairId, std::size_t> row;
  for (std::size_t r = 0; r < all.size(); ++r) row[host.contacts.pair[r]] = r;
  double largest = 0, apart = 0;
  for (std::size_t r = 0; r < all.size(); ++r) {
    const std::size_t of_host = row.at(all[r]);
    const double closing = -host.relative(of_host, (end - x) / dt).dot(host.normal(of_host));
    const double expected = r % 3 == 0 ? 7 + static_cast<double>(r) : closing;
    largest = std::max(largest, std::abs(closing));
    apart = std::max(apart, std::abs(first[r] - closing));
    EXPECT_NEAR(found.kept[r], expected, 1e-12);
    EXPECT_NEAR(found.strength[r], host.strength[of_host] / std::max(expected, 0.01),
                1e-12 * host.strength[of_host]);
  }
  ASSERT_GT(largest, 0.1);
  ASSERT_GT(apart, 0.1);
}

// An archive from before the first step takes the speeds of a later one back.
TEST(LaggedRows, MeetWithTheSpeedsOfTheSceneWhereAnArchiveHasNone) {
  const Scene scene = with_restitution(full_scene(3));
  const Positions x = shaken(scene), end = random_motion(x, 5e-3, 7);
  TestedExecutor executor;
  OnRows on = restitution_on(executor, scene, x, dt);
  const std::vector<double> first = on.family->known("restitution").kept;
  Archive none;
  restitution_on(executor, scene, x, dt).family->keep(none);
  upload(on.y, end);
  on.family->end_step(on.y.data());
  Archive again(none.bytes());
  on.family->keep(again);
  KnownLag nobody = on.family->known("restitution");
  for (PairId& pair : nobody.pair) pair = 0;  // so that all pairs are new
  on.family->adopt(nobody);
  on.take();
  EXPECT_EQ(on.family->known("restitution").kept, first);
  ASSERT_GT(*std::max_element(first.begin(), first.end()), 0.1);
}

// The sides of two edges of which one counts with an end alone are two bodies, whatever obstacles there are.
TEST(LaggedRows, TakeAnEndOfAnEdgeForNoObstacle) {
  const double of_body[] = {0.2, 0.5}, of_obstacle[] = {7};
  const int body[] = {0, 0, 1, 1}, vertex[] = {0, 1, 2, 3};
  const SideCoefficients sides{of_body, of_obstacle, body, CombineRule::max};
  EXPECT_EQ(sides.of(vertex, 1, pair_id(0, 0, 0)), 0.5);
  EXPECT_EQ(sides.of(vertex, 1, pair_id(end_pairs, 0, 0)), 0.5);
  EXPECT_EQ(sides.of(vertex, 1, pair_id(obstacle_pairs, 0, 0)), 7);
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
TEST(LaggedRows, FollowTheSurfaceOfObstaclesThatTurn) {
  const Scene scene = with_vertices_of_obstacles(full_scene(3));
  const Positions x = shaken(scene);
  TestedExecutor executor;
  const FrictionOptions options = friction_options("capped", CombineRule::max);
  OnRows on = friction_on(executor, scene, x, options);
  std::vector<ObstacleTurn> turns;
  for (std::size_t o = 0; o < scene.obstacles.size(); ++o) {
    ObstacleTurn& turn = turns.emplace_back();
    turn.kind = scene.obstacles[o].kind;
    turn.radius = scene.obstacles[o].radius;
    Vec3d::Map(turn.axis) = scene.obstacles[o].axis;
    turn.turns = o != 2;
    Mat3d::Map(turn.lag) = turned(0.1 + static_cast<double>(o));
    Mat3d::Map(turn.begin) = turned(0.3);
    Mat3d::Map(turn.end) = turned(0.7);
  }
  exec::Buffer<ObstacleTurn> there(executor, "turns");
  there.upload(turns);
  const Index n = on.family->size();
  exec::Buffer<double> spin(executor, "spin", 3 * n);
  LaggedColumns& columns = on.family->rows();
  const LaggedRows view{n,       columns.vertex.data(), columns.weight.data(), columns.normal.data(), nullptr,
                        nullptr, on.x_n.data()};
  executor.each(n, FindSpins{view, columns.pair.data(), there.data(), on.x_n.data(), spin.data()});
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

TEST(LaggedRows, HaveTheSameBitsInEveryOrder) {
  const Scene scene = with_friction(full_scene(5), Sides(full_scene(5), CombineRule::mean));
  const Positions x = shaken(scene), y = random_motion(x, eps_m, 6), given = motion_of_given(scene);
  const FrictionOptions options = friction_options("smoothed_coulomb", CombineRule::mean);
  std::optional<Sums> first;
  for (const exec::Order order : all_orders) {
    TestedExecutor executor(order, 5);
    OnRows on = friction_on(executor, scene, x, options);
    const Sums found = on.sums(y, given);
    if (!first) first = found;
    EXPECT_EQ(found.gradient, first->gradient);
    EXPECT_EQ(found.matrix, first->matrix);
    EXPECT_EQ(found.force, first->force);
    EXPECT_EQ(found.energy, first->energy);
  }
}

/// Element by element, as the CPU path reads them, row by row what an executor has.
void expect_same_bits(OnRows& of_executor, OnRows& of_host, const Positions& y) {
  of_executor.sums(y, y);
  of_executor.family->gradients(of_executor.y.data(), of_executor.energy.data(), of_executor.force.data());
  upload(of_host.y, y);
  const auto n = static_cast<std::size_t>(of_host.family->size());
  ASSERT_EQ(of_host.family->size(), of_executor.family->size());
  LocalTerms local;
  local.resize(n, 4);
  of_host.family->derivatives(of_host.y.data(), local);
  EXPECT_EQ(of_executor.energy.download(), local.energy);
  const std::vector<double> weight = of_host.family->rows().weight.download(),
                            force = of_executor.force.download(), hess = of_executor.hess.download();
  double largest = 0;
  for (std::size_t r = 0; r < n; ++r) {
    const double w = weight[r];  // of the first vertex
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(local.grad[12 * r + c], w * force[c * n + r]);
    EXPECT_EQ(local.hess[90 * r], w * w * hess[r]);
    largest = std::max(largest, std::abs(local.hess[90 * r]));
  }
  EXPECT_GT(largest, 1);
}

TEST(LaggedRows, HaveTheBitsOfTheCpuPath) {
  const Sides sides(full_scene(3), CombineRule::max);
  const Scene scene = with_restitution(with_friction(full_scene(3), sides));
  const Positions x = shaken(scene), y = random_motion(x, eps_m, 6);
  TestedExecutor executor;
  exec::HostExecutor host;
  for (const std::string& law : friction_law_names()) {
    SCOPED_TRACE(law);
    const FrictionOptions options = friction_options(law, CombineRule::max);
    OnRows a = friction_on(executor, scene, x, options), b = friction_on(host, scene, x, options);
    expect_same_bits(a, b, y);
  }
  OnRows a = restitution_on(executor, scene, x, dt), b = restitution_on(host, scene, x, dt);
  expect_same_bits(a, b, y);
}

}  // namespace
}  // namespace bb::lagged_rows_test
