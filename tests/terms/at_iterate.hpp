// All terms of the scene with everything at an iterate, and what tests read of their gradients and Hessians.
#pragma once

#include <gtest/gtest.h>

#include "tests/oracle/dense.hpp"
#include "tests/terms/all_terms.hpp"

namespace bb::test {

/// All terms at an iterate that is a little away from where the step began.
struct AtIterate : TermsOf {
  Positions x;

  AtIterate() : AtIterate(scene_with_everything()) {}
  explicit AtIterate(const Scene& all) : AtIterate(all, [](TermOptions&) {}) {}
  template <class Change>
  AtIterate(const Scene& all, const Change& change)
      : TermsOf(all, all.x0, frame(all), change), x(disturbed(scene, 0.004)) {
    for (const auto& term : terms) term->linearise(scene.x0, context());
    move_to(x);
  }
  void move_to(const Positions& to, Projection projection = Projection::psd) {
    x = to;
    trial(x);
    for (const auto& term : terms) {
      term->accept(clock);
      term->take_energies();
    }
    for (const auto& term : terms) term->begin_iterate(x);
    for (const auto& term : terms) term->linearise(x, context(projection));
  }
  static StepFrame frame(const Scene& scene) {
    StepFrame out;
    out.x_n = scene.x0;
    out.x_tilde = scene.x0;
    out.x_tilde.row(2).array() -= 0.01;
    out.dt = 0.05;
    return out;
  }
  void trial(const Positions& to) {
    const Positions dx = to - scene.x0;
    for (const auto& term : terms) {
      term->prepare({scene.x0, to, dx}, clock);
      ASSERT_TRUE(is_feasible(*term, x, to, clock)) << term->name();
      term->freeze(clock);
      term->evaluate(to);
    }
  }
};

/// Ascending, of the symmetric matrix on `width` points with these lower blocks.
inline Eigen::VectorXd eigenvalues(int width, const double* blocks) {
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(3 * width, 3 * width);
  for (int b = 0; b < width; ++b) {
    for (int a = b; a < width; ++a, blocks += 9)
      lower.block<3, 3>(3 * a, 3 * b) = Mat<double, 3, 3>::Map(blocks);
  }
  return eigenvalues(lower);
}

inline Positions gradient_of(const HostTerm& term, Eigen::Index n_vertices) {
  Positions out = Positions::Zero(3, n_vertices);
  for (const TermFamily& family : term.families()) {
    const std::span<const int> vertices = family.stencils.vertices;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      if (vertices[i] >= 0) out.col(vertices[i]) += Vec3d::Map(&family.local.grad[3 * i]);
    }
  }
  return out;
}

/// dx^T H dx over all elements, H with the lower blocks of each.
inline double curvature_along(const HostTerm& term, const Positions& dx) {
  double sum = 0;
  for (const TermFamily& family : term.families()) {
    const auto width = static_cast<std::size_t>(family.stencils.width);
    const double* block = family.local.hess.data();
    for (std::size_t e = 0; e < family.stencils.size() && !family.local.hess.empty(); ++e) {
      const auto of = [&](std::size_t a) -> Vec3d {
        const int vertex = family.stencils.vertices[width * e + a];
        return vertex < 0 ? Vec3d::Zero() : Vec3d(dx.col(vertex));
      };
      for (std::size_t b = 0; b < width; ++b) {
        for (std::size_t a = b; a < width; ++a, block += 9) {
          sum += (a == b ? 1 : 2) * of(a).dot(Mat<double, 3, 3>::Map(block) * of(b));
        }
      }
    }
  }
  return sum;
}

}  // namespace bb::test
