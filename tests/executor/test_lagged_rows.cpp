// Families of rows on lagged contacts, friction and restitution, on an executor against the functions of core/energy row by row:
// coefficients and loads of the rows, gradient, matrix, motion of prescribed vertices; and against their form for the CPU path bit by bit.
#include <gtest/gtest.h>

#include <optional>

#include "tests/executor/lagged_fixture.hpp"

namespace bb::lagged_rows_test {
namespace {

/// Of laws with two coefficients the kinetic ones of bodies and obstacles are other parts of the static ones.
template <class Law>
Sides kinetic_sides(const Sides& sides) {
  Sides out = sides;
  if (!Law::two_coefficients) return out;
  for (double& mu : out.of_body) mu *= 0.5;
  for (double& mu : out.of_obstacle) mu *= 0.8;
  return out;
}
template <class Law>
Scene rubbing_scene(const Sides& sides) {
  Scene scene = with_friction(full_scene(3), kinetic_sides<Law>(sides));
  if (!Law::two_coefficients) return scene;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) scene.bodies[i].friction_static = sides.of_body[i];
  for (std::size_t i = 0; i < scene.obstacles.size(); ++i)
    scene.obstacles[i].friction_static = sides.of_obstacle[i];
  return scene;
}

template <class Law>
void expect_friction(const std::string& law_name, CombineRule rule, unsigned seed) {
  const Sides sides(full_scene(3), rule);
  const Scene scene = rubbing_scene<Law>(sides);
  const Positions x = shaken(scene), y = random_motion(x, 0.7 * eps_m, seed), given = motion_of_given(scene);
  const HostLaggedState host(scene, x, sides), kinetic(scene, x, kinetic_sides<Law>(sides));
  int slides = 0, sticks = 0;
  double work = 0;
  const Sums expected =
      sums_of(host, scene, y - x, given, [&](const HostLaggedState& lagged, std::size_t r, const Vec3d& way) {
        const Vec3d slide = slide_of<double>(way, lagged.normal(r));
        const double part = lagged.strength[r] > 0 ? kinetic.strength[r] / lagged.strength[r] : 1;
        const LawInTerm<Law, double> law{{eps_m, part, 10 * eps_m}};
        if (lagged.strength[r] > 0) ++(slide.norm() < eps_m ? sticks : slides);
        work += friction_work(slide.norm(), lagged.strength[r], law);
        return friction_of_slide<double>(slide, lagged.normal(r), lagged.strength[r], law);
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
    expect_friction<friction_laws::static_kinetic>("static_kinetic", rule, 10);
  }
}

TEST(LaggedRows, HaveTheRestitutionOfTheContacts) {
  const Scene scene = with_restitution(full_scene(3));
  const Positions x = shaken(scene), y = random_motion(x, eps_m, 5), given = motion_of_given(scene);
  const HostLaggedState host(scene, x, restitution_sides(scene));
  constexpr double length = 5e-5;  // s, so short that contacts that open yield
  double work = 0;
  std::size_t damps = 0, yields = 0, slow = 0;
  const Sums expected =
      sums_of(host, scene, y - x, given, [&](const HostLaggedState& lagged, std::size_t r, const Vec3d& way) {
        const double met = -lagged.relative(r, scene.v0).dot(lagged.normal(r));
        slow += met < 0.01;
        const double a = lagged.strength[r] / std::max(met, 0.01);
        const ContactDamping<double> damping{a / length, lagged.contacts.load[r]};
        const double opening = way.dot(lagged.normal(r));
        ++(damping.force(opening) < damping.load ? damps : yields);
        work += damping.force(opening) * opening;
        return damping_terms<double>(way, lagged.normal(r), damping);
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
