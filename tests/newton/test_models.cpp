// Bodies of different membrane models in one scene: each has the energy and the forces of its own.
#include <gtest/gtest.h>

#include "tests/newton/small_scenes.hpp"

namespace bb::models_test {
namespace {

BodySpec stretched(const std::string& name, const std::string& model, double height) {
  BodySpec spec = test::cloth_spec(4, height, 0.001);
  spec.name = name;
  spec.material.model = model;
  spec.start = spec.mesh.vertices;
  spec.start->row(0) *= 1.3;
  spec.start->row(1) *= 0.8;
  return spec;
}

struct Assembled {
  double elastic = 0;  // J
  Positions gradient;  // [3 x n] N
};

Assembled assemble(const std::vector<BodySpec>& bodies) {
  SceneBuilder builder("cloths", false, Vec3d::Zero(), "test");
  for (const BodySpec& body : bodies) builder.add_body(body);
  const Scene scene = builder.finish();
  Method method = test::fixed_method("log", 1);
  NewtonSystem system(scene, method);
  Prediction prediction;
  prediction.x_tilde = scene.x0;
  system.begin_step(scene.x0, prediction, 0.01, 1);
  system.assemble();
  Assembled out;
  out.elastic = system.energy(TermGroup::elastic);
  out.gradient = system.gradient();
  return out;
}

TEST(Models, every_body_keeps_its_own) {
  const BodySpec low = stretched("low", "stvk", 0), high = stretched("high", "baraff_witkin", 1);
  const Assembled first = assemble({low}), second = assemble({high}), both = assemble({low, high});
  ASSERT_GT(std::abs(first.elastic - second.elastic), 0.1 * first.elastic);  // the models differ
  EXPECT_NEAR(both.elastic, first.elastic + second.elastic, 1e-12 * both.elastic);
  EXPECT_LT((both.gradient.leftCols(16) - first.gradient).norm(), 1e-12 * first.gradient.norm());
  EXPECT_LT((both.gradient.rightCols(16) - second.gradient).norm(), 1e-12 * second.gradient.norm());
}

}  // namespace
}  // namespace bb::models_test
