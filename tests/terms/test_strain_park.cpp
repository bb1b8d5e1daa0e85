// What the strain bound leaves of an element's width: the park distance, or half of what there was. Stretches are the roots of the
// eigenvalues of the two Gram matrices of the edges, in long double: nothing of the code under test.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "tests/terms/all_terms.hpp"

namespace bb::strain_park_test {
namespace {

using MatrixXl = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;

template <std::size_t N>
MatrixXl gram(const Positions& x, const std::array<int, N>& corners) {
  MatrixXl edges(3, static_cast<Eigen::Index>(N) - 1);
  for (std::size_t k = 1; k < N; ++k) {
    edges.col(static_cast<Eigen::Index>(k) - 1) =
        x.col(corners[k]).template cast<long double>() - x.col(corners[0]).template cast<long double>();
  }
  return edges.transpose() * edges;
}

template <std::size_t N>
double largest_stretch(const Scene& scene, const Positions& x, const std::array<int, N>& corners) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXl> found(gram(x, corners), gram(scene.rest, corners));
  return static_cast<double>(std::sqrt(found.eigenvalues().maxCoeff()));
}

/// 1 + onset + width - stretch over the width, of each element.
template <class Elements>
void add_gaps(const Scene& scene, const Positions& x, const Elements& elements, const StrainBands& bands,
              std::vector<double>& out) {
  for (std::size_t e = 0; e < elements.size(); ++e) {
    const double stretch = largest_stretch(scene, x, elements[e]);
    out.push_back((1 + bands.onset[e] + bands.width[e] - stretch) / bands.width[e]);
  }
}

std::vector<double> gaps_of(const Scene& scene, const Positions& x) {
  std::vector<double> out;
  add_gaps(scene, x, scene.limit.triangles, scene.limit, out);
  add_gaps(scene, x, scene.solid_limit.tetrahedra, scene.solid_limit, out);
  return out;
}

/// A sheet and a block, one of which is limited.
Scene limited(bool solid) {
  SceneBuilder builder("limited", false, Vec3d(0, 0, -10), "test");
  BodySpec sheet;
  sheet.name = "sheet";
  sheet.mesh = grid_mesh(4, 4, 1.0, 1.0);
  sheet.d_hat = 0.01;
  if (!solid) sheet.material.limit = StrainLimitSpec{0.02, 0.1};
  builder.add_body(sheet);
  BodySpec block;
  block.name = "block";
  block.mesh = solid_box_mesh({2, 1, 1}, Vec3d(0.6, 0.4, 0.3));
  block.mesh.vertices.colwise() += Vec3d(3, 0, 1);
  block.material.solid_density = 10;
  block.d_hat = 0.01;
  if (solid) block.material.limit = StrainLimitSpec{0.02, 0.1, true};
  builder.add_body(block);
  return builder.finish();
}

TEST(StrainPark, IsLeftOfTheWidthByTheBound) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  int stopped = 0, near = 0, judged = 0;
  for (const bool solid : {false, true}) {
    const Scene scene = limited(solid);
    for (int trial = 0; trial < 120; ++trial) {
      const double park = trial % 3 == 0 ? 1e-6 : trial % 3 == 1 ? 1e-3 : 0.1;
      Positions x0 = scene.x0, dx = x0;
      for (Eigen::Index i = 0; i < x0.size(); ++i) x0.data()[i] += 0.004 * unit(rng);
      // every fifth starts nearer to the limit than two park distances
      const double size = trial % 5 == 0 ? 1 + 0.02 + 0.1 * (1 - 1.5 * park) : 1 + 0.05 * (unit(rng) + 1);
      if (trial % 5 == 0) x0 = scene.x0;
      x0 *= size;
      for (Eigen::Index i = 0; i < dx.size(); ++i) dx.data()[i] = 0.3 * unit(rng);
      const std::vector<double> before = gaps_of(scene, x0);
      if (!(*std::min_element(before.begin(), before.end()) > 0)) continue;
      StepFrame frame;
      frame.x_n = frame.x_tilde = x0;
      frame.dt = 0.01;
      test::TermsOf of(scene, x0, frame, [&](TermOptions& options) {
        options.contact_options.min_gap_fraction = park;
        options.solid_limit_stiffness = test::fixed_limit(30);
      });
      double alpha = 1;
      for (const auto& term : of.terms) {
        if (term->name() != "strain_limit") continue;
        IterateNumbers report;
        alpha = std::min(alpha, test::bound(*term, {x0, Positions(x0 + dx), dx, true}, report, of.clock));
        ++judged;
      }
      const std::vector<double> left = gaps_of(scene, x0 + alpha * dx);
      double spare = std::numeric_limits<double>::infinity();
      for (std::size_t e = 0; e < left.size(); ++e) {
        const double promised = before[e] < 2 * park ? before[e] / 2 : park;
        EXPECT_GE(left[e], promised * (1 - 1e-7) - 1e-13) << trial << (solid ? " of solids" : "");
        spare = std::min(spare, left[e] - promised);
        near += before[e] < 2 * park;
      }
      if (alpha == 1) continue;
      ++stopped;
      EXPECT_LT(spare, 1e-6) << trial << ": it could have gone on";
    }
  }
  EXPECT_GT(judged, 150);
  EXPECT_GT(stopped, 100);
  EXPECT_GT(near, 10);
}

}  // namespace
}  // namespace bb::strain_park_test
