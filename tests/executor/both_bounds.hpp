// The step bound of a motion on an executor, by lists and by trees, against that of the CPU path.
#pragma once

#include <gtest/gtest.h>

#include "tests/executor/contact_motion.hpp"
#include "tests/executor/tested_executor.hpp"

namespace bb::test {

using exec::BoundBatches;

/// By lists and by trees, with the same batches.
struct BothBounds {
  StepBound listed, unlisted;
};
inline BothBounds bounds(exec::Executor& executor, ExecutorMotion& motion, const BoundBatches& batches = {}) {
  exec::ExecutorStepBound bound(executor, motion.surface_there, stop_level, batches);
  motion.update();
  return {bound.find(motion.candidates, motion.x0, motion.x1),
          bound.find_without_list(motion.broad_phase.source(), motion.x0, motion.x1)};
}
inline BothBounds bounds(const Scene& scene, const Positions& x1, const BoundBatches& batches = {}) {
  TestedExecutor executor;
  ExecutorMotion motion(executor, scene, scene.x0, x1);
  return bounds(executor, motion, batches);
}

inline void expect_same(const StepBound& found, const StepBound& expected) {
  EXPECT_EQ(found.alpha, expected.alpha);
  EXPECT_EQ(found.kind, expected.kind);
  EXPECT_EQ(found.key, expected.key);
  EXPECT_EQ(found.zero, expected.zero);
  EXPECT_EQ(found.capped, 0);
}

/// Counts into n_of_kind what limits; 7: nothing does.
inline void expect_that_of_the_cpu_path(const Scene& scene, const Positions& x1,
                                        std::array<int, 8>& n_of_kind) {
  const Candidates candidates = cpu_candidates(scene, scene.x0, x1);
  const StepBound expected = cpu_bound(scene, candidates, scene.x0, x1);
  const BothBounds found = bounds(scene, x1);
  expect_same(found.listed, expected);
  expect_same(found.unlisted, expected);
  const std::size_t n = candidates.point_point.size() + candidates.point_edge.size() +
                        candidates.point_triangle.size() + candidates.edge_edge.size() +
                        candidates.obstacle_edge.size() + candidates.obstacle_triangle.size();
  EXPECT_LE(static_cast<std::size_t>(found.listed.queries), n);
  EXPECT_GE(found.listed.probes, found.listed.queries);
  ++n_of_kind[expected.alpha < 1 ? static_cast<std::size_t>(expected.kind) : 7];
}

}  // namespace bb::test
