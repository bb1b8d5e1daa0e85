// What the tests of the step bound share.
#pragma once

#include "tests/contact/contact_scenes.hpp"

namespace bb::test {

inline constexpr double d_hat = 0.01;

inline StepBound bound(const Scene& scene, const Positions& x1) {
  ContactSystem contacts(scene, {});
  contacts.update_candidates(scene.x0, x1);
  return contacts.step_bound(scene.x0, x1);
}

inline std::size_t n_pairs(const Scene& scene, const Positions& x1) {
  ContactSystem contacts(scene, {});
  contacts.update_candidates(scene.x0, x1);
  const ContactSystem::Counts counts = contacts.candidate_counts();
  return counts.point_point + counts.point_edge + counts.point_triangle + counts.edge_edge;
}

}  // namespace bb::test
