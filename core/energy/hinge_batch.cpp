// Loops over hinges.
#include "core/energy/hinge_batch.hpp"

#include "core/energy/element_loop.hpp"
#include "core/energy/hinge_lanes.hpp"

namespace bb {

HingeBatch::HingeBatch(std::span<const std::array<int, 4>> hinges, std::vector<double> stiffness,
                       std::vector<double> rest_angle, Precision precision)
    : stiffness_(std::move(stiffness)), rest_angle_(std::move(rest_angle)), precision_(precision) {
  check_column("hinge/stiffness", hinges.size(), stiffness_, false);
  check_column("hinge/rest_angle", hinges.size(), rest_angle_, false);
  for (const auto& hinge : hinges) vertices_.insert(vertices_.end(), hinge.begin(), hinge.end());
}

void HingeBatch::values(const PositionsView& x, double* energy) const {
  const auto value = [&]<class T>(std::size_t e) {
    return energy_of<T>(Points<4, T>(x, vertices_, e).x, e).energy;
  };
  store_energies(size(), precision_, value, energy);
}

void HingeBatch::derivatives(const PositionsView& x, Projection projection, LocalTerms& out) const {
  out.resize(size(), width());
  for_each_pass(precision_, [&]<class T>(PassParts parts) { fill<T>(x, projection, parts, out); });
}

std::vector<std::size_t> HingeBatch::cusps(const PositionsView& x) const {
  return elements_where(size(), precision_, [&]<class T>(std::size_t e) {
    const Points<4, T> p(x, vertices_, e);
    const double stiffness = stiffness_[e] + (exponential_.empty() ? 0 : exponential_[e]);
    return hinge_is_cusp<T>(p.x, static_cast<T>(stiffness), static_cast<T>(rest_angle_[e]));
  });
}

template <class T>
void HingeBatch::fill(const PositionsView& x, Projection projection, PassParts parts, LocalTerms& out) const {
  constexpr std::size_t lanes = hinge_lanes;
  for_each_element((size() + lanes - 1) / lanes, [&](std::size_t g) {
    const std::size_t first = lanes * g, n = std::min(lanes, size() - first);
    HingesAbreast<T> hinges;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::size_t e = first + std::min(lane, n - 1);  // lanes beyond the end repeat the last hinge
      const Points<4, T> p(x, vertices_, e);
      hinges.set(static_cast<int>(lane), p.x, energy_of<T>(p.x, e));
    }
    TermsAbreast<T, hinge_lanes, 4> terms;
    hinge_terms_abreast(hinges, projection, terms);
    store_abreast(terms, first, n, parts, out);
  });
}

template <class T>
HingeEnergy<T> HingeBatch::energy_of(const Vec<T, 3> (&p)[4], std::size_t e) const {
  const T stiffness = static_cast<T>(stiffness_[e]), rest_angle = static_cast<T>(rest_angle_[e]);
  if (exponential_.empty()) return hinge_energy<T>(p, stiffness, rest_angle);
  return hinge_energy<T>(p, stiffness, static_cast<T>(exponential_[e]), static_cast<T>(exponent_[e]),
                         rest_angle);
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

}  // namespace bb
