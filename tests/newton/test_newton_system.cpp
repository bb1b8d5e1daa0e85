// The system of one iterate by hand: which states are feasible, what the matrix holds, what is measured.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/contact/contact_scenes.hpp"
#include "tests/newton/small_scenes.hpp"

namespace bb::newton_system_test {
namespace {

constexpr double d_hat = 0.01, dt = 0.01;
constexpr TermSet without_contact = TermSet::all().without(TermGroup::contact);

/// A system at the start of a step from rest.
struct AtRest {
  Method method;
  NewtonSystem system;

  AtRest(const Scene& scene, Method chosen, const Positions& x)
      : method(std::move(chosen)), system(scene, method) {
    Prediction at_rest;
    at_rest.x_tilde = x;
    system.begin_step(x, at_rest, dt, 1.0);
  }
};

TEST(NewtonSystem, a_state_in_contact_or_beyond_it_has_no_energy) {
  const Scene scene = test::particle_over_plane(0.2, 0.5 * d_hat, d_hat);
  AtRest rest(scene, test::fixed_method("cubic", 10), scene.x0);
  rest.system.assemble();
  for (const double z : {0.0, -0.5 * d_hat}) {
    const Positions x = test::one_point(0, 0, z);
    EXPECT_FALSE(test::try_state(rest.system, x).has_value()) << z;
  }
  EXPECT_TRUE(test::try_state(rest.system, test::one_point(0, 0, 1e-6 * d_hat)).has_value());
}

/// One free triangle with legs of 2 m and a limit of 2 %, onset 1 %.
Scene limited_triangle() {
  SceneBuilder builder("triangle", false, Vec3d::Zero(), "test");
  BodySpec spec;
  spec.name = "triangle";
  spec.mesh.vertices.resize(3, 3);
  spec.mesh.vertices << 0, 2, 0, 0, 0, 2, 0, 0, 0;
  spec.mesh.triangles = {{0, 1, 2}};
  spec.material.youngs = 1;
  spec.material.limit = StrainLimitSpec{0.01, 0.01};
  spec.d_hat = d_hat;
  builder.add_body(spec);
  return builder.finish();
}

/// Stretched along x by 1 + strain.
Positions stretched(const Scene& scene, double strain) {
  Positions x = scene.rest;
  x.row(0) *= 1 + strain;
  return x;
}

TEST(NewtonSystem, a_state_at_its_strain_limit_or_beyond_has_no_energy) {
  const Scene scene = limited_triangle();
  Method method = test::fixed_method("cubic", 1);
  method.limit_stiffness = test::fixed_limit(30);
  AtRest rest(scene, std::move(method), scene.x0);
  rest.system.assemble();
  for (const double strain : {0.021, 0.1}) {
    EXPECT_FALSE(test::try_state(rest.system, stretched(scene, strain)).has_value()) << strain;
  }
  EXPECT_TRUE(test::try_state(rest.system, stretched(scene, 0.019)).has_value());
}

TEST(NewtonSystem, the_tension_of_the_limit_is_the_force_per_width) {
  const Scene scene = limited_triangle();
  Method method = test::fixed_method("cubic", 1);
  method.limit_stiffness = test::fixed_limit(30);
  const double strain = 0.015, width = 0.01, beyond = strain - 0.01;
  AtRest rest(scene, std::move(method), stretched(scene, strain));
  rest.system.assemble();
  const IterateNumbers said = test::reported(rest.system);
  EXPECT_NEAR(said.max_stretch.value, strain, 1e-12);
  EXPECT_NEAR(said.limit_load_max_N_per_m.value, 30 * 2 / width * beyond * beyond, 1e-9);
  EXPECT_NEAR(rest.system.view().energy(TermGroup::limit), 30 * 2.0 * 2 / (3 * width) * std::pow(beyond, 3),
              1e-12);  // area 2
}

TEST(NewtonSystem, the_factor_of_a_limit_that_makes_its_own_stiffness_multiplies_it) {
  const Scene scene = limited_triangle();
  const auto energy = [&scene](double multiplier) {
    Method method = test::fixed_method("cubic", 1);
    method.limit_stiffness = test::elastic_limit({}, multiplier);
    AtRest rest(scene, std::move(method), stretched(scene, 0.015));
    rest.system.assemble();
    return rest.system.view().energy(TermGroup::limit);
  };
  ASSERT_GT(energy(1), 0);
  EXPECT_NEAR(energy(3) / energy(1), 3, 1e-12);
}

TEST(NewtonSystem, planar_scenes_have_no_unknowns_out_of_their_plane) {
  Scene scene = test::particle_over_plane(0.2, 1, d_hat);
  scene.obstacles.clear();
  for (const bool planar : {false, true}) {
    scene.planar = planar;
    Method method = test::fixed_method("cubic", 1);
    const NewtonSystem system(scene, method);
    EXPECT_EQ(system.view().fixed(), (std::vector<std::uint8_t>{0, 0, planar}));
    EXPECT_EQ(system.view().n_free(), planar ? 2 : 3);
  }
}

TEST(NewtonSystem, the_largest_gradient_is_that_of_free_vertices) {
  Scene scene;
  test::add_body(scene, "pair", {Vec3d(0, 0, 0), Vec3d(1, 0, 0)}, {}, d_hat);
  scene.pins = {{0, 0}};
  scene.motions.resize(1);
  scene.mass = {5, 2};
  scene.gravity = Vec3d(0, 0, -10);
  AtRest rest(scene, test::fixed_method("cubic", 1), scene.x0);
  rest.system.assemble();
  EXPECT_EQ(rest.system.view().grad_inf(), 20);  // and not the 50 N that the pin holds
}

/// A particle of 0.2 kg in contact: M/h^2 with and without kappa b'' along z.
TEST(NewtonSystem, stages_hold_the_terms_that_they_are_named_after) {
  const Scene scene = test::particle_over_plane(0.2, 0.5 * d_hat, d_hat);
  AtRest rest(scene, test::fixed_method("quadratic", 7), scene.x0);
  rest.system.assemble();
  const double inertia = 0.2 / (dt * dt), curvature = 7 * 2;
  const auto vertical = [&rest](TermSet set) {
    return rest.system.diagnosis().clamped(set).lower.coeff(2, 2);
  };
  EXPECT_DOUBLE_EQ(vertical(TermSet::all()), inertia + curvature);
  EXPECT_TRUE(rest.system.diagnosis().active(TermGroup::contact));
  EXPECT_DOUBLE_EQ(vertical(without_contact), inertia);
  EXPECT_DOUBLE_EQ(vertical(TermGroup::contact), curvature);
  EXPECT_FALSE(rest.system.diagnosis().active(TermGroup::limit));

  const double mean = inertia + curvature / 3;
  EXPECT_NEAR(rest.system.add_tikhonov(1e-3, 1e-8), 1e-3 * mean, 1e-9);
  EXPECT_NEAR(rest.system.diagnosis().solved().lower.coeff(2, 2), inertia + curvature + 1e-3 * mean, 1e-9);
  EXPECT_DOUBLE_EQ(vertical(TermSet::all()), inertia + curvature);  // clamped matrices are without it
  EXPECT_FALSE(rest.system.diagnosis().solved_is_clamped());
  EXPECT_EQ(rest.system.add_tikhonov(1e-12, 0.5), 0.5);
}

/// A shift is one of the matrix that is there: the next one has none, and its factor proves a minimum again.
TEST(NewtonSystem, a_shift_ends_with_its_matrix) {
  const Scene scene = test::particle_over_plane(0.2, 0.5 * d_hat, d_hat);
  Method method = test::fixed_method("quadratic", 7);
  method.hessian_mode = HessianMode::projected_full;
  for (const HessianChoice& choice : hessian_choices()) method.step_hessian[choice.name] = StepHessian::blend;
  AtRest rest(scene, std::move(method), scene.x0);
  Positions dx;
  const auto proven = [&](double shift) {
    rest.system.assemble();
    if (shift > 0) rest.system.add_tikhonov(0, shift);
    EXPECT_EQ(test::solve(rest.system, scene.x0, dx).linear.status, LinearStatus::ok);
    return rest.system.check_end();
  };
  EXPECT_EQ(proven(0).proof, EndProof::factor);
  EXPECT_EQ(proven(0).factorizations, 0);
  EXPECT_GT(proven(0.5).factorizations, 0) << "the factor that is there is of another matrix";
  EXPECT_EQ(proven(0).factorizations, 0);
}

/// Of conjugate gradients: what has solved the exact matrix proves the end, so that nothing is clamped for it.
TEST(NewtonSystem, the_end_of_an_exact_solve_is_proven_without_clamped_elements) {
  const Scene scene = test::particle_over_plane(0.2, 0.5 * d_hat, d_hat);
  Method method = test::fixed_method("quadratic", 7);
  method.linear.name = "pcg";
  method.hessian_mode = HessianMode::projected_full;
  for (const HessianChoice& choice : hessian_choices()) method.step_hessian[choice.name] = StepHessian::blend;
  AtRest rest(scene, std::move(method), scene.x0);
  Positions dx;
  const auto clamped_numbers = [&] {
    std::size_t n = 0;
    for (const auto& term : rest.system.diagnosis().terms()) {
      for (const TermFamily& family : term->families()) n += family.clamped.hess.size();
    }
    return n;
  };
  for (const double shift : {0.0, 0.5}) {
    rest.system.assemble();
    if (shift > 0) rest.system.add_tikhonov(0, shift);
    EXPECT_EQ(test::solve(rest.system, scene.x0, dx).linear.status, LinearStatus::ok);
    const EndCheck end = rest.system.check_end();
    EXPECT_EQ(end.proof, EndProof::lanczos);
    EXPECT_GT(end.iterations, 0);
    EXPECT_EQ(clamped_numbers() > 0, shift > 0)
        << "the matrix with a shift is another one than that in question";
  }
}

TEST(NewtonSystem, without_the_limit_a_stage_has_only_elasticity_and_inertia) {
  const Scene scene = limited_triangle();
  Method method = test::fixed_method("cubic", 1);
  method.limit_stiffness = test::fixed_limit(1e4);
  AtRest rest(scene, std::move(method), stretched(scene, 0.015));
  rest.system.assemble();
  ASSERT_TRUE(rest.system.diagnosis().active(TermGroup::limit));
  const double with = rest.system.diagnosis().clamped().lower.diagonal().sum();
  const double without =
      rest.system.diagnosis().clamped(without_contact.without(TermGroup::limit)).lower.diagonal().sum();
  EXPECT_GT(with, 2 * without);
}

/// A given plate that rises under a particle over its middle vertex, where six pairs have one closest feature. Newton's
/// model is linear: (m/h^2 + 6 kappa b'') dz = 6 kappa |b'| - m g + 6 kappa b'' rise.
TEST(NewtonSystem, the_motion_of_a_prescribed_vertex_reaches_every_pair) {
  Scene scene;
  const auto [vertices, triangles] = test::grid(2, 2, 1.0);
  test::add_body(scene, "plate", vertices, triangles, d_hat, true);
  test::add_body(scene, "particle", {Vec3d(1, 1, 0.5 * d_hat)}, {}, d_hat);
  scene.gravity = Vec3d(0, 0, -10);
  AtRest rest(scene, test::fixed_method("quadratic", 300), scene.x0);
  rest.system.assemble();
  ASSERT_EQ(test::rows_of(rest.system).rows.size(), 6U);
  const double rise = 0.002, curvature = 6 * 300 * 2, force = 6 * 300 * 2 * 0.5 * d_hat;
  Positions target = scene.x0, dx;
  target.leftCols(9).row(2).array() += rise;
  ASSERT_EQ(test::solve(rest.system, target, dx).linear.status, LinearStatus::ok);
  EXPECT_NEAR(dx(2, 9), (force - 10 + curvature * rise) / (1 / (dt * dt) + curvature), 1e-12);
  EXPECT_EQ(dx(2, 4), rise);
}

}  // namespace
}  // namespace bb::newton_system_test
