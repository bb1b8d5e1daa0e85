// Loops over hinges.
#include "core/energy/hinge_batch.hpp"

#include "core/energy/element_loop.hpp"
#include "core/energy/hinge.hpp"
#include "core/math/lanes.hpp"
#include "core/math/lower_blocks.hpp"

namespace bb {

namespace {

// The projection's chain of square roots and divisions bounds a hinge: four run side by side.
constexpr std::size_t kLanes = 4;

template <class T>
struct HingeGroup {
  using Real = Lanes<T, kLanes>;
  Vec<Real, 3> x[4];
  Real stiffness, deviation;

  void set(std::size_t lane, const Vec<T, 3> (&points)[4], T k, T turned) {
    for (int i = 0; i < 4; ++i) {
      for (int c = 0; c < 3; ++c) x[i][c].v[lane] = points[i][c];
    }
    stiffness.v[lane] = k;
    deviation.v[lane] = turned;
  }
};

template <class Real>
void store(const ElementTerms<Real, 12>& terms, std::size_t first, std::size_t n, PassParts parts,
           LocalTerms& out) {
  for (std::size_t lane = 0; lane < n; ++lane) {
    const std::size_t e = first + lane;
    if (parts.values) {
      out.energy[e] = terms.energy.v[lane];
      for (std::size_t k = 0; k < 12; ++k) out.grad[12 * e + k] = terms.grad.data()[k].v[lane];
    }
    if (!parts.hessians) continue;
    store_lower_blocks(4, terms.hess, &out.hess[n_lower_numbers(4) * e],
                       [lane](const Real& entry) -> double { return entry.v[lane]; });
  }
}

}  // namespace

HingeBatch::HingeBatch(std::span<const std::array<int, 4>> hinges, std::vector<double> stiffness,
                       std::vector<double> rest_angle, Precision precision)
    : stiffness_(std::move(stiffness)), rest_angle_(std::move(rest_angle)), precision_(precision) {
  check_column("hinge/stiffness", hinges.size(), stiffness_, false);
  check_column("hinge/rest_angle", hinges.size(), rest_angle_, false);
  for (const auto& hinge : hinges) vertices_.insert(vertices_.end(), hinge.begin(), hinge.end());
}

void HingeBatch::values(const PositionsView& x, double* energy) const {
  const auto value = [&]<class T>(std::size_t e) {
    const Points<4, T> p(x, vertices_, e);
    return hinge_value<T>(p.x, static_cast<T>(stiffness_[e]), static_cast<T>(rest_angle_[e]));
  };
  store_energies(size(), precision_, value, energy);
}

void HingeBatch::derivatives(const PositionsView& x, Projection projection, LocalTerms& out) const {
  out.resize(size(), width());
  for_each_pass(precision_, [&]<class T>(PassParts parts) { fill<T>(x, projection, parts, out); });
}

template <class T>
void HingeBatch::fill(const PositionsView& x, Projection projection, PassParts parts, LocalTerms& out) const {
  using Real = typename HingeGroup<T>::Real;
  for_each_element((size() + kLanes - 1) / kLanes, [&](std::size_t g) {
    const std::size_t first = kLanes * g, n = std::min(kLanes, size() - first);
    HingeGroup<T> group;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const std::size_t e = first + std::min(lane, n - 1);  // lanes beyond the end repeat the last hinge
      const Points<4, T> p(x, vertices_, e);
      const T rest = static_cast<T>(rest_angle_[e]);
      group.set(lane, p.x, static_cast<T>(stiffness_[e]), hinge_deviation<T>(hinge_angle<T>(p.x), rest));
    }
    store<Real>(hinge_terms_at<Real>(group.x, group.stiffness, group.deviation, projection), first, n, parts,
                out);
  });
}

std::vector<double> hinge_angles(std::span<const std::array<int, 4>> hinges, const PositionsView& x) {
  std::vector<double> angles;
  for (const auto& [e0, e1, v0, v1] : hinges) {
    const Vec3d points[4] = {x.col(e0), x.col(e1), x.col(v0), x.col(v1)};
    angles.push_back(hinge_angle<double>(points));
  }
  return angles;
}

}  // namespace bb
