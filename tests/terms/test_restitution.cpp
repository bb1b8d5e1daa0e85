// Restitution: the damping that a share of speed needs, and the term that applies it.
#include "core/energy/restitution.hpp"

#include <gtest/gtest.h>

#include "core/base/archive/archive.hpp"
#include "core/contact/contact_loads.hpp"
#include "tests/terms/at_iterate.hpp"

namespace bb::restitution_test {
namespace {

using test::AtIterate, test::curvature_along, test::gradient_of, test::iterate_energy;

constexpr double half = 0.5;  // restitution of the cloths of scene_with_everything()

/// Speed with which a unit mass that comes with v leaves a contact of load g^power, g its way into it; classical Runge-Kutta.
double speed_after(double v, double a, int power) {
  double way = 0, speed = v;
  const auto pull = [&](double g, double s) { return -std::pow(std::max(g, 0.0), power) * (1 + a * s); };
  constexpr double h = 1e-5;
  do {
    const double a1 = pull(way, speed), a2 = pull(way + h / 2 * speed, speed + h / 2 * a1);
    const double a3 = pull(way + h / 2 * (speed + h / 2 * a1), speed + h / 2 * a2);
    const double a4 = pull(way + h * (speed + h / 2 * a2), speed + h * a3);
    way += h * (speed + h / 6 * (a1 + a2 + a3));
    speed += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  } while (way > 0);
  return -speed;
}

TEST(RestitutionDamping, LeavesTheShareOfTheSpeedForAnyLoadAndSpeed) {
  for (const double e : {0.98, 0.7, 0.3}) {
    const double y = restitution_damping(e);
    ASSERT_GT(y, 0);
    for (const double v : {0.2, 3.0}) {
      for (const int power : {1, 3}) EXPECT_NEAR(speed_after(v, y / v, power) / v, e, 1e-4) << e << " " << v;
    }
  }
}

TEST(RestitutionDamping, IsNothingForAllAndAtMostThatOfOneHundredth) {
  EXPECT_EQ(restitution_damping(1), 0);
  EXPECT_NEAR(restitution_damping(1 - 1e-6), 1.5e-6, 1e-9);  // 3/2 (1 - e^2)/(1 + e^3) near 1
  EXPECT_EQ(restitution_damping(0), restitution_damping(0.01));
  EXPECT_NEAR(restitution_damping(0.01), 100, 1);
  EXPECT_GT(restitution_damping(0.2), restitution_damping(0.3));
}

TEST(ContactDamping, HoldsAnOpeningGapBackByTheLoadAtMost) {
  const ContactDamping<double> damping{40, 2};  // N/m, N: the load is reached at 5 cm
  const Vec3d n = Vec3d(1, 2, 2) / 3, across = Vec3d(2, -2, 1) / 3;
  std::size_t yields = 0;
  for (const double way : {-0.3, -0.01, 0.0, 0.02, 0.0499, 0.0501, 0.2}) {
    const auto terms = damping_terms<double>(way * n + 0.7 * across, n, damping);
    const double force = std::min(40 * way, 2.0);  // towards a gap that closes as before
    EXPECT_NEAR(terms.grad.dot(n), force, 1e-12) << way;
    EXPECT_NEAR(terms.grad.dot(across), 0, 1e-12) << way;
    EXPECT_NEAR(n.dot(terms.hess * n), way < 0.05 ? 40 : 0, 1e-12) << way;
    EXPECT_NEAR(terms.energy, way < 0.05 ? 20 * way * way : 0.05 + 2 * (way - 0.05), 1e-12) << way;
    EXPECT_EQ(damping_value<double>(way * n, n, damping), damping.energy((way * n).dot(n)));
    EXPECT_NEAR(damping_work<double>(way * n, n, damping), force * way, 1e-12) << way;
    constexpr double h = 1e-6;
    EXPECT_NEAR((damping.energy(way + h) - damping.energy(way - h)) / (2 * h), force, 1e-6) << way;
    EXPECT_NEAR((damping.force(way + h) - damping.force(way - h)) / (2 * h), damping.stiffness(way), 1e-6)
        << way;
    yields += way > 0.05;
  }
  EXPECT_EQ(yields, 2u);
  // a contact that carries nothing does nothing
  EXPECT_EQ(damping_terms<double>(n, n, ContactDamping<double>{0, 0}).grad, Vec3d::Zero());
}

const HostTerm& restitution(const TermList& terms) {
  return **std::find_if(terms.begin(), terms.end(),
                        [](const auto& term) { return term->name() == "restitution"; });
}

/// By how much the gap of contact r opens from a to b.
double opening(const ContactLoads& loads, std::size_t r, const Positions& a, const Positions& b) {
  Vec3d motion = Vec3d::Zero();
  for (std::size_t k = 4 * r; k < 4 * r + 4 && loads.stencil[k] >= 0; ++k) {
    motion += loads.weight[k] * (b.col(loads.stencil[k]) - a.col(loads.stencil[k]));
  }
  return motion.dot(Vec3d::Map(&loads.normal[3 * r]));
}

ContactLoads loads_at_start(const Scene& scene) {
  test::TermsOf start(scene, scene.x0, AtIterate::frame(scene));
  for (const auto& term : start.terms) term->linearise(scene.x0, start.context());
  ContactLoads out;
  for (const auto& term : start.terms) term->add_loads(scene.x0, out);
  return out;
}

TEST(Restitution, DampsEveryContactBySpeedAtMeetingAndLoad) {
  Scene scene = test::scene_with_everything();
  for (Eigen::Index v = 0; v < scene.v0.cols(); ++v)
    scene.v0(2, v) = v < 9 ? -2.0 : -0.3;  // the lower cloth faster
  const ContactLoads loads = loads_at_start(scene);
  AtIterate at(scene);
  const HostTerm& term = restitution(at.terms);
  ASSERT_GT(term.size(), 20U);
  ASSERT_EQ(term.size(), loads.size());
  const double dt = AtIterate::frame(scene).dt;
  double energy = 0, fast = 0;
  std::size_t yields = 0;
  for (std::size_t r = 0; r < loads.size(); ++r) {
    const double met = -opening(loads, r, Positions::Zero(3, scene.v0.cols()), scene.v0);
    const double damping = loads.load[r] * restitution_damping(half) / std::max(met, 1e-2);
    fast += met > 1;
    const double way = opening(loads, r, scene.x0, at.x), reach = loads.load[r] * dt / damping;
    yields += way > reach;
    energy += way > reach ? loads.load[r] * (way - reach / 2) : damping / (2 * dt) * way * way;
  }
  EXPECT_EQ(fast, 9);  // that meet the floor; the upper cloth is left behind
  ASSERT_GT(energy, 1e-4);
  EXPECT_GT(yields, 0U);
  EXPECT_LT(yields, loads.size());
  EXPECT_NEAR(iterate_energy(term), energy, 1e-11 * energy);
}

TEST(Restitution, HasTheGradientAndHessianOfItsEnergy) {
  AtIterate at;
  const HostTerm& term = restitution(at.terms);
  const Positions x = at.x, gradient = gradient_of(term, x.cols());
  const Positions along = test::disturbed(at.scene, 1e-5) - at.scene.x0;
  const double curvature = curvature_along(term, along), slope = gradient.cwiseProduct(along).sum();
  ASSERT_GT(std::abs(slope), 1e-4);
  ASSERT_GT(curvature, 1e-6);
  const double here = iterate_energy(term);
  at.move_to(x + 0.5 * along);
  const double ahead = iterate_energy(restitution(at.terms));
  at.move_to(x - 0.5 * along);
  const double behind = iterate_energy(restitution(at.terms));
  // a quadratic as long as no contact begins to yield: both differences are exact but for rounding
  EXPECT_NEAR(ahead - behind, slope, 1e-10 * here);
  EXPECT_NEAR(4 * (ahead - 2 * here + behind), curvature, 1e-10 * here);
}

// Pairs that stay keep the speed at which they met, in a checkpoint too; those that come later have that of their time.
TEST(Restitution, RemembersTheSpeedOfMeeting) {
  Scene scene = test::scene_with_everything();
  for (Body& body : scene.bodies) body.restitution.reset();
  scene.obstacles[0].restitution = half;
  scene.v0.row(2).array() = -2.0;
  const StepFrame frame = AtIterate::frame(scene);
  const auto next_step = [&frame](const TermList& terms, PhaseClock& clock) {
    for (const auto& term : terms) term->begin_step(frame, clock);
  };
  const auto energy_of = [&scene](AtIterate& at) {
    for (const auto& term : at.terms) term->linearise(scene.x0, at.context());
    at.move_to(test::disturbed(scene, 0.004));
    return iterate_energy(restitution(at.terms));
  };
  AtIterate first(scene), other(scene);
  const double met = iterate_energy(restitution(first.terms));
  Positions slow = scene.x0;  // the step before the next one moves by nothing
  for (const auto& term : first.terms) term->end_step(slow, first.clock);
  Archive kept;
  for (const auto& term : first.terms) term->keep(kept);
  next_step(first.terms, first.clock);
  ASSERT_GT(met, 1e-6);
  EXPECT_NEAR(energy_of(first), met, 1e-12 * met);

  for (const auto& term : other.terms) term->end_step(slow, other.clock);
  Archive read(kept.bytes());
  for (const auto& term : other.terms) term->keep(read);
  EXPECT_TRUE(read.at_end());
  next_step(other.terms, other.clock);
  EXPECT_EQ(energy_of(other), energy_of(first));

  Scene at_rest = scene;
  at_rest.v0.setZero();
  AtIterate rests(at_rest);
  EXPECT_GT(iterate_energy(restitution(rests.terms)), 10 * met);  // met with less: damped more
}

TEST(Restitution, IsMadeOnlyWhereSomeContactIsDamped) {
  Scene scene = test::scene_with_everything();
  const TermOptions options = test::term_options();
  const auto needed = [&] { return make_plan(scene, options, {}).term("restitution").needed; };
  EXPECT_TRUE(needed());
  for (Body& body : scene.bodies) body.restitution.reset();
  EXPECT_FALSE(needed());
  scene.obstacles[0].restitution = 0.9;
  EXPECT_TRUE(needed());
  test::TermsOf with(scene, scene.x0, AtIterate::frame(scene));
  EXPECT_EQ(restitution(with.terms).size(), 9U);  // the vertices above the floor
}

}  // namespace
}  // namespace bb::restitution_test
