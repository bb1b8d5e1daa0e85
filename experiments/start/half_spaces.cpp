#include "experiments/start/half_spaces.hpp"

#include <algorithm>
#include <cmath>

namespace bb {
namespace {

/// sum_k weight[k]^2 / m_k: how fast a multiplier opens its half-space.
double mobility(const HalfSpace& side, const std::vector<double>& inverse_mass) {
  double sum = 0;
  for (std::size_t k = 0; k < 4 && side.vertex[k] >= 0; ++k)
    sum += side.weight[k] * side.weight[k] * inverse_mass[static_cast<std::size_t>(side.vertex[k])];
  return sum * side.normal.squaredNorm();
}

double value(const HalfSpace& side, const Positions& y) {
  double sum = 0;
  for (std::size_t k = 0; k < 4 && side.vertex[k] >= 0; ++k)
    sum += side.weight[k] * side.normal.dot(y.col(side.vertex[k]));
  return sum;
}

/// Returns how far the farthest vertex went, m.
double add(const HalfSpace& side, double multiplier, const std::vector<double>& inverse_mass, Positions& y) {
  double farthest = 0;
  for (std::size_t k = 0; k < 4 && side.vertex[k] >= 0; ++k) {
    const double way = multiplier * side.weight[k] * inverse_mass[static_cast<std::size_t>(side.vertex[k])];
    y.col(side.vertex[k]) += way * side.normal;
    farthest = std::max(farthest, std::abs(way));
  }
  return farthest * side.normal.norm();
}

}  // namespace

Positions nearest_point(const Positions& target, const std::vector<HalfSpace>& sides,
                        const std::vector<double>& inverse_mass, double tolerance, int most_sweeps) {
  Positions y = target;
  std::vector<double> multiplier(sides.size(), 0), mobile(sides.size());
  for (std::size_t i = 0; i < sides.size(); ++i) mobile[i] = mobility(sides[i], inverse_mass);
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    double farthest = 0;
    for (std::size_t i = 0; i < sides.size(); ++i) {
      if (!(mobile[i] > 0)) continue;
      const double change = std::max(-multiplier[i], (sides[i].bound - value(sides[i], y)) / mobile[i]);
      if (change == 0) continue;
      multiplier[i] += change;
      farthest = std::max(farthest, add(sides[i], change, inverse_mass, y));
    }
    if (farthest <= tolerance) break;
  }
  return y;
}

}  // namespace bb
