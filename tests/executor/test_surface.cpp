// Primitives of a scene in an executor's memory are those of its Surface.
#include "core/contact/executor/executor_surface.hpp"

#include <gtest/gtest.h>

#include "core/exec/host_executor.hpp"
#include "tests/executor/tested_executor.hpp"

namespace {

using namespace bb;

TEST(ExecutorSurface, HoldsTheSurface) {
  Scene scene;
  scene.rest.resize(3, 4);
  scene.rest << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  scene.x0 = scene.rest;
  scene.mass.assign(4, 1);
  scene.body.assign(4, 0);
  scene.d_hat = {0.1, 0.2, 0.3, 0.4};
  scene.offset.assign(4, 0.01);
  scene.surface_triangles = {{0, 1, 2}, {0, 2, 3}};
  scene.surface_vertices = {0, 1, 2, 3};
  scene.pins.push_back({3, 0});
  scene.obstacles.emplace_back();
  const Surface surface(scene);
  test::TestedExecutor executor;
  const exec::ExecutorSurface there(executor, scene, surface);
  const exec::SurfaceView view = there.view();
  ASSERT_EQ(view.triangles.n, 2);
  ASSERT_EQ(view.edges.n, 5);
  ASSERT_EQ(view.points.n, 4);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(view.edges.vertex[2 * i + 1], surface.edges.vertices[i][1]);
    EXPECT_EQ(view.edges.d_hat[i], surface.edges.side[i].d_hat);
    EXPECT_EQ(view.edges.offset[i], 0.01);
  }
  EXPECT_EQ(view.vertex_free[3], 0);
  EXPECT_EQ(view.points.free[3], 0);
  EXPECT_EQ(view.rest[3 * 3 + 2], 1);
  EXPECT_EQ(view.n_obstacles, 1);
}

}  // namespace
