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
  Real energy, stiffness, deviation;

  /// turned: by how much from rest. bent: what that costs.
  void set(std::size_t lane, const Vec<T, 3> (&points)[4], T turned, const Stiffened<T>& bent, bool linear) {
    for (int i = 0; i < 4; ++i) {
      for (int c = 0; c < 3; ++c) x[i][c].v[lane] = points[i][c];
    }
    energy.v[lane] = bent.energy;
    stiffness.v[lane] = bent.curvature;
    deviation.v[lane] = linear || !(bent.curvature > T(0)) ? turned : bent.slope / bent.curvature;
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
    return bent<T>(e, hinge_deviation<T>(hinge_angle<T>(p.x), static_cast<T>(rest_angle_[e]))).energy;
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
      const T turned = hinge_deviation<T>(hinge_angle<T>(p.x), static_cast<T>(rest_angle_[e]));
      group.set(lane, p.x, turned, bent<T>(e, turned), exponential_.empty());
    }
    store<Real>(hinge_terms_of<Real>(group.x, group.energy, group.stiffness, group.deviation, projection),
                first, n, parts, out);
  });
}

template <class T>
Stiffened<T> HingeBatch::bent(std::size_t e, T deviation) const {
  const T k = static_cast<T>(stiffness_[e]);
  if (exponential_.empty()) return {k / T(2) * deviation * deviation, k * deviation, k};
  return stiffened<T>(deviation, k, static_cast<T>(exponential_[e]), static_cast<T>(exponent_[e]));
}

void HingeBatch::set_stiffening(std::vector<double> exponential, std::vector<double> exponent) {
  check_column("hinge/exponential", size(), exponential, false);
  check_column("hinge/exponent", size(), exponent, true);
  exponential_ = std::move(exponential);
  exponent_ = std::move(exponent);
}

void HingeBatch::set_creep(std::vector<double> yield, std::vector<double> rate) {
  check_column("hinge/yield", size(), yield, false);
  check_column("hinge/creep", size(), rate, false);
  yield_ = std::move(yield);
  rate_ = std::move(rate);
}

std::span<const double> HingeBatch::memory() const {
  return rate_.empty() ? std::span<const double>() : std::span<const double>(rest_angle_);
}

void HingeBatch::set_memory(std::span<const double> memory) {
  rest_angle_.assign(memory.begin(), memory.end());
}

void HingeBatch::flow(const PositionsView& x, double dt, std::span<double> memory) const {
  for_each_element(rate_.size(), [&](std::size_t e) {
    const Points<4> p(x, vertices_, e);
    memory[e] = crept_rest_angle<double>(p.x, rest_angle_[e], yield_[e], kept_after(rate_[e], dt));
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
