// The seam by which a term reads the contacts of an earlier one, and the friction term that does.
#include <gtest/gtest.h>

#include "core/contact/contact_loads.hpp"
#include "core/terms/contact.hpp"
#include "tests/terms/at_iterate.hpp"

namespace bb::friction_test {
namespace {

using test::AtIterate, test::gradient_of, test::iterate_energy;

constexpr double mu = 0.4, eps = 1e-3 * 0.05;  // of term_options(), and eps_v dt of AtIterate

struct AtStart : test::TermsOf {
  AtStart() : AtStart(test::scene_with_everything(), [](TermOptions&) {}) {}
  template <class Change>
  AtStart(const Scene& all, const Change& change) : TermsOf(all, all.x0, AtIterate::frame(all), change) {}
  void linearise() {
    for (const auto& term : terms) term->linearise(scene.x0, context());
  }
  const ContactTerm& contact() const { return *terms.find<ContactTerm>(); }
  ContactLoads loads() const {
    ContactLoads out;
    for (const auto& term : terms) term->add_loads(scene.x0, out);
    return out;
  }
  const HostTerm& friction() const {
    for (const auto& term : terms) {
      if (term->name() == "friction") return *term;
    }
    throw std::logic_error("no friction");
  }
};

TEST(ContactLoads, AreTheForcesOfTheRowsOnceTheTermIsLinearised) {
  AtStart at;
  for (const double load : at.loads().load) EXPECT_EQ(load, 0);  // no stiffness yet
  at.linearise();
  const ContactLoads loads = at.loads();
  const std::size_t n = at.contact().state().rows.size();
  ASSERT_GT(n, 10U);
  Positions pushed = Positions::Zero(3, at.scene.n_vertices()), gradient = pushed;
  std::size_t of_floor = 0;
  for (std::size_t r = 0; r < n; ++r) {
    double sum = 0;
    for (std::size_t k = 4 * r; k < 4 * r + 4 && loads.stencil[k] >= 0; ++k) {
      pushed.col(loads.stencil[k]) += loads.load[r] * loads.weight[k] * Vec3d::Map(&loads.normal[3 * r]);
      sum += loads.weight[k];
    }
    EXPECT_GT(loads.load[r], 0);
    EXPECT_NEAR(sum, pair_obstacle(loads.pair[r]) == 0 ? 1 : 0, 1e-12);
    of_floor += pair_obstacle(loads.pair[r]) == 0;
  }
  EXPECT_EQ(of_floor, 9U);  // every vertex of the lower cloth
  const TermFamily& rows = at.contact().families()[0];
  for (std::size_t i = 0; i < rows.stencils.vertices.size(); ++i) {
    const int vertex = rows.stencils.vertices[i];
    if (vertex >= 0) gradient.col(vertex) += Vec3d::Map(&rows.local.grad[3 * i]);
  }
  ASSERT_GT(gradient.norm(), 0.1);
  EXPECT_LT((gradient + pushed).norm(), 1e-12 * gradient.norm());
}

TEST(ContactLoads, OfMollifiedRowsHaveTheirMollifier) {
  AtStart at;
  at.linearise();
  const MollifiedTable& rows = at.contact().state().mollified;
  const ContactLoads loads = at.loads();
  const std::size_t first = at.contact().state().rows.size();
  ASSERT_EQ(loads.size(), first + rows.size());
  ASSERT_GT(rows.size(), 0U);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double energy = at.contact().families()[1].local.energy[r];  // m kappa e b
    EXPECT_NEAR(loads.load[first + r], -energy * rows.db[r] / rows.b[r], 1e-14);
    double sum = 0, size = 0;
    for (std::size_t k = 4 * (first + r); k < 4 * (first + r) + 4; ++k) {
      sum += loads.weight[k];
      size += std::abs(loads.weight[k]);
    }
    EXPECT_NEAR(sum, 0, 1e-12);
    EXPECT_NEAR(size, 2, 1e-12);
  }
}

TEST(Friction, BeginsAStepAtRestWithTheLoadsOfContact) {
  AtStart at;
  at.linearise();
  const ContactLoads loads = at.loads();
  double expected = 0;
  for (const double load : loads.load) expected += mu * load * eps / 3;
  ASSERT_GT(expected, 1e-6);
  EXPECT_EQ(at.friction().size(), loads.size());
  EXPECT_NEAR(iterate_energy(at.friction()), expected, 1e-13 * expected);
  EXPECT_TRUE(gradient_of(at.friction(), at.scene.n_vertices()).isZero(0));
}

// What changes within the step, loads and normals of contact, changes nothing of it but the slide.
TEST(Friction, KeepsItsLoadsForTheStep) {
  AtStart start;
  start.linearise();
  const ContactLoads lagged = start.loads();
  AtIterate at;  // a little away from there
  double expected = 0;
  for (std::size_t r = 0; r < lagged.size(); ++r) {
    Vec3d motion = Vec3d::Zero();
    for (std::size_t k = 4 * r; k < 4 * r + 4 && lagged.stencil[k] >= 0; ++k) {
      const int v = lagged.stencil[k];
      motion += lagged.weight[k] * (at.x.col(v) - at.scene.x0.col(v));
    }
    const double slide = motion.cross(Vec3d::Map(&lagged.normal[3 * r])).norm();
    const double y = slide / eps;
    expected += mu * lagged.load[r] * (y >= 1 ? slide : eps * (1. / 3 + y * y - y * y * y / 3));
  }
  const auto friction = std::find_if(at.terms.begin(), at.terms.end(),
                                     [](const auto& term) { return term->name() == "friction"; });
  ASSERT_GT(expected, 1e-4);
  EXPECT_NEAR(iterate_energy(**friction), expected, 1e-11 * expected);
  StepNumbers end;
  (*friction)->report_end(at.x, end, at.clock);
  EXPECT_GT(end.friction_sliding, 10);
  EXPECT_EQ(end.friction_sliding + end.friction_sticking,
            std::count_if(lagged.load.begin(), lagged.load.end(), [](double load) { return load > 0; }));
  EXPECT_NEAR(end.friction_dissipation_J.value, expected, 0.02 * expected);  // nearly all of them slide far
}

/// lambda = mu load/max(eps, |u|) of every contact of x, and what its matrix has along dx, the same twice.
struct PublishedForm {
  Positions gradient;
  double curvature = 0;
  int sliding = 0, sticking = 0;
};
PublishedForm published(const AtIterate& at, const Positions& dx, double eps_m) {
  ContactLoads now;
  for (const auto& term : at.terms) term->add_loads(at.x, now);
  PublishedForm out{Positions::Zero(3, at.scene.n_vertices())};
  for (std::size_t r = 0; r < now.size(); ++r) {
    Vec3d u = Vec3d::Zero(), along = Vec3d::Zero();
    const Vec3d n = Vec3d::Map(&now.normal[3 * r]);
    const auto each = [&](const auto& f) {
      for (std::size_t k = 4 * r; k < 4 * r + 4 && now.stencil[k] >= 0; ++k) f(now.stencil[k], now.weight[k]);
    };
    each([&](int v, double w) {
      u += w * (at.x.col(v) - at.scene.x0.col(v));
      along += w * dx.col(v);
    });
    u -= n.dot(u) * n, along -= n.dot(along) * n;
    const double lambda = mu * now.load[r] / std::max(eps_m, u.norm());
    each([&](int v, double w) { out.gradient.col(v) += lambda * w * u; });
    out.curvature += lambda * along.squaredNorm();
    ++(u.norm() < eps_m ? out.sticking : out.sliding);
  }
  return out;
}

TEST(Friction, OfEveryIterateHasTheLoadsNormalsAndWeightsThatItHasThere) {
  constexpr double eps_m = 6e-3;
  const AtIterate at(test::scene_with_everything(), [&](TermOptions& options) {
    options.friction.law = "capped";
    options.friction.refresh = FrictionRefresh::per_iteration;
    options.friction.hessian = FrictionHessian::secant;
    options.friction.eps_m = eps_m;
  });
  const auto friction = std::find_if(at.terms.begin(), at.terms.end(),
                                     [](const auto& term) { return term->name() == "friction"; });
  const Positions dx = test::disturbed(at.scene, 0.01) - at.scene.x0;
  const PublishedForm expected = published(at, dx, eps_m);
  ASSERT_GT(expected.sliding, 10);
  ASSERT_GT(expected.sticking, 3);
  const Positions found = gradient_of(**friction, at.scene.n_vertices());
  ASSERT_GT(found.norm(), 1e-3);
  EXPECT_LT((found - expected.gradient).norm(), 1e-12 * found.norm());
  EXPECT_NEAR(test::curvature_along(**friction, dx), expected.curvature, 1e-11 * expected.curvature);
  AtStart start;  // of the start of the step: other loads, and fewer or more contacts
  start.linearise();
  EXPECT_NE(start.friction().size(), (*friction)->size());
}

TEST(Friction, CombinesTheCoefficientsOfTheTwoSides) {
  Scene scene = test::scene_with_everything();
  scene.bodies[0].friction = 0.2;
  scene.bodies[1].friction = 0.6;
  scene.obstacles[0].friction = 0.8;
  struct Expected {
    CombineRule rule;
    double with_floor, between;
  };
  for (const Expected& e : {Expected{CombineRule::min, 0.2, 0.2}, Expected{CombineRule::max, 0.8, 0.6},
                            Expected{CombineRule::mean, 0.5, 0.4}}) {
    AtStart at(scene, [&](TermOptions& options) { options.friction.combine = e.rule; });
    at.linearise();
    const ContactLoads loads = at.loads();
    double expected = 0;
    for (std::size_t r = 0; r < loads.size(); ++r) {
      expected += (pair_obstacle(loads.pair[r]) == 0 ? e.with_floor : e.between) * loads.load[r] * eps / 3;
    }
    ASSERT_GT(expected, 1e-6);
    EXPECT_NEAR(iterate_energy(at.friction()), expected, 1e-13 * expected);
  }
}

TEST(Friction, LeavesOutWhatHasNoCoefficientAndIsMadeOnlyWhereSomeContactCanRub) {
  Scene scene = test::scene_with_everything();
  scene.obstacles[0].friction = 0;
  AtStart at(scene, [](TermOptions&) {});
  at.linearise();
  const ContactLoads loads = at.loads();
  const auto of_floor = std::count_if(loads.pair.begin(), loads.pair.end(),
                                      [](PairId pair) { return pair_obstacle(pair) == 0; });
  EXPECT_EQ(at.friction().size() + static_cast<std::size_t>(of_floor), loads.size());

  TermOptions options = test::term_options();
  const auto needed = [&](const Scene& of) { return make_plan(of, options, {}).term("friction").needed; };
  EXPECT_TRUE(needed(scene));
  options.friction.mu = 0;
  EXPECT_FALSE(needed(scene));
  scene.obstacles[0].friction = 0.5;
  EXPECT_FALSE(needed(scene));  // the smaller one is 0
  options.friction.combine = CombineRule::mean;
  EXPECT_TRUE(needed(scene));
  scene.obstacles[0].friction.reset();
  scene.bodies[1].friction = 0.1;
  options.friction.combine = CombineRule::min;
  EXPECT_TRUE(needed(scene));
}

}  // namespace
}  // namespace bb::friction_test
