// Loops over hinges.
#include "core/energy/hinge_batch.hpp"

#include "core/energy/element_loop.hpp"
#include "core/energy/hinge.hpp"

namespace bb {

HingeBatch::HingeBatch(std::span<const std::array<int, 4>> hinges, std::vector<double> stiffness,
                       std::vector<double> rest_angle)
    : stiffness_(std::move(stiffness)), rest_angle_(std::move(rest_angle)) {
  check_column("hinge/stiffness", hinges.size(), stiffness_, false);
  check_column("hinge/rest_angle", hinges.size(), rest_angle_, false);
  for (const auto& hinge : hinges) vertices_.insert(vertices_.end(), hinge.begin(), hinge.end());
}

void HingeBatch::values(const Positions& x, double* energy) const {
  for_each_element(size(), [&](std::size_t e) {
    const Points<4> p(x, vertices_, e);
    energy[e] = hinge_value<double>(p.x, stiffness_[e], rest_angle_[e]);
  });
}

void HingeBatch::derivatives(const Positions& x, LocalTerms& out) const {
  out.resize(size(), width());
  for_each_element(size(), [&](std::size_t e) {
    const Points<4> p(x, vertices_, e);
    store_terms(hinge_terms<double>(p.x, stiffness_[e], rest_angle_[e], Projection::psd), e, out);
  });
}

std::vector<double> hinge_angles(std::span<const std::array<int, 4>> hinges, const Positions& x) {
  std::vector<double> angles;
  for (const auto& [e0, e1, v0, v1] : hinges) {
    const Vec3d points[4] = {x.col(e0), x.col(e1), x.col(v0), x.col(v1)};
    angles.push_back(hinge_angle<double>(points));
  }
  return angles;
}

}  // namespace bb
