// Which elements, bodies and vertices the ends of the spectrum are reported to live on, where that is known.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/step_solvers/simulation.hpp"
#include "experiments/run/spectrum_ends.hpp"
#include "tests/linear/systems.hpp"
#include "tests/newton/small_scenes.hpp"
#include "tests/oracle/dense.hpp"

namespace bb::spectrum_ends_test {
namespace {

double share_of(const SpectrumEnd& end, const std::string& term) {
  for (const TermShare& share : end.terms) {
    if (share.term == term) return share.share;
  }
  return 0;
}

/// Looks at the matrix of the first iteration of every step.
struct EndsOf final : StepObserver {
  TermSet set;
  Scaling scaling = Scaling::none;
  std::vector<SpectrumEnd> ends;
  Eigen::VectorXd dense;
  void on_matrix(StepSystem& step_system, int, int iteration) override {
    if (iteration > 0) return;
    Diagnosis& system = step_system.on_host().diagnosis();
    const ReducedSystem& matrix = system.clamped(set);
    dense = test::eigenvalues(bb::dense(matrix));
    const auto vectors = end_vectors(matrix, scaling, 5);
    ends.clear();
    if (vectors) ends = describe_ends(system, set, *vectors);
  }
};

/// A cloth of 16 vertices, 0.3 kg per m^2, whose corner 0 alone is in contact with a plane: as if pressed on a tack.
Scene cloth_on_its_corner() {
  BodySpec spec = test::cloth_spec(4, 0.05, 0.02);
  spec.mesh.vertices(2, 0) = 0.012;
  SceneBuilder builder("cloth on its corner", false, Vec3d(0, 0, -10), "test");
  builder.add_body(spec);
  Obstacle plane;
  plane.name = "floor";
  builder.add_obstacle(plane);
  return builder.finish();
}

TEST(SpectrumEnds, a_stiff_contact_is_the_largest_end_and_inertia_the_smallest) {
  Scene scene = test::particle_over_plane(0.2, 0.009, 0.02);
  Method method = test::fixed_method("quadratic", 1e7);
  Simulation simulation(scene, method, 0.01, 1);
  EndsOf seen;
  seen.set = TermSet::all();
  simulation.step(seen);
  ASSERT_EQ(seen.ends.size(), 2U);
  const SpectrumEnd &low = seen.ends[0], &high = seen.ends[1];
  EXPECT_EQ(low.side, SpectrumSide::smallest);
  EXPECT_NEAR(low.lambda, 0.2 / 1e-4, 1e-6);         // M/h^2
  EXPECT_NEAR(high.lambda, 0.2 / 1e-4 + 2e7, 1e-3);  // and kappa b'' = 2 kappa along the normal
  EXPECT_NEAR(share_of(low, "inertia"), 1, 1e-12);
  EXPECT_NEAR(share_of(high, "contact"), 2e7 / (2e7 + 2000), 1e-12);
  EXPECT_EQ(high.element, "contact: obstacle: floor, particle[0]");
  EXPECT_EQ(low.element, "inertia: particle[0]");
  EXPECT_EQ(high.terms.front().term, "contact");
}

TEST(SpectrumEnds, the_shares_of_all_terms_add_up_to_the_dense_eigenvalue) {
  const Scene scene = cloth_on_its_corner();
  Method method = test::fixed_method("cubic", 3e4);
  for (const TermSet set : {TermSet::all(), TermSet::all().without(TermGroup::contact)}) {
    EndsOf seen;
    seen.set = set;
    Simulation(scene, method, 0.01, 1).step(seen);
    ASSERT_EQ(seen.ends.size(), 2U);
    EXPECT_NEAR(seen.ends[0].lambda / seen.dense[0], 1, 1e-6);
    EXPECT_NEAR(seen.ends[1].lambda / seen.dense[seen.dense.size() - 1], 1, 1e-6);
    for (const SpectrumEnd& end : seen.ends) {
      double sum = 0;
      for (const TermShare& share : end.terms) sum += share.share;
      EXPECT_NEAR(sum, 1, 1e-12);
      EXPECT_GT(end.terms.size(), 1U);
      EXPECT_TRUE(std::is_sorted(end.terms.begin(), end.terms.end(),
                                 [](const TermShare& a, const TermShare& b) { return a.share > b.share; }));
      EXPECT_NEAR(end.body_share, 1, 1e-12);
      EXPECT_EQ(end.body, "cloth");
    }
    const bool contact = set.has(TermGroup::contact);
    EXPECT_EQ(share_of(seen.ends[1], "contact") > 0.9, contact);
    EXPECT_EQ(seen.ends[1].element.rfind("contact: obstacle: floor, cloth[0]", 0) == 0, contact)
        << seen.ends[1].element;
    if (contact) {
      EXPECT_EQ(seen.ends[1].vertex, 0);
      EXPECT_LT(seen.ends[1].vertices, 1.1);  // on one vertex
      EXPECT_NE(seen.ends[0].vertex, 0);
    }
  }
}

TEST(SpectrumEnds, block_jacobi_takes_a_single_stiff_vertex_off_the_largest_end) {
  const Scene scene = cloth_on_its_corner();
  Method method = test::fixed_method("cubic", 3e4);
  EndsOf seen;
  seen.set = TermSet::all();
  seen.scaling = Scaling::block_jacobi;
  Simulation(scene, method, 0.01, 1).step(seen);
  ASSERT_EQ(seen.ends.size(), 2U);
  EXPECT_LT(share_of(seen.ends[1], "contact"), 0.5);
  EXPECT_GT(seen.ends[1].vertices, 2);
}

}  // namespace
}  // namespace bb::spectrum_ends_test
