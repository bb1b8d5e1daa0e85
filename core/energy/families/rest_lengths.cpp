#include "core/energy/families/rest_lengths.hpp"

#include <fmt/format.h>

#include "core/math/error.hpp"

namespace bb {
namespace {

double distance(const Positions& x, const std::array<int, 2>& pair) {
  return (x.col(pair[1]) - x.col(pair[0])).norm();
}

}  // namespace

RestLengths::RestLengths(std::span<const std::array<int, 2>> pairs, std::vector<double> start,
                         MovingRest rest)
    : pairs_(pairs), start_(std::move(start)), now_(start_), rest_(std::move(rest)) {
  if (!rest_.moves()) return;
  for (const auto& pair : pairs_) apart_.push_back(distance(rest_.start(), pair));
  move(0);
}

bool RestLengths::move(double t) {
  if (!rest_.move(t)) return false;
  const Positions& x = rest_.now();
  for (std::size_t e = 0; e < pairs_.size(); ++e) {
    const double length = distance(x, pairs_[e]);
    if (!(length > 0)) {
      throw ConfigError("rest_film",
                        fmt::format("the scene's vertices {} and {} at one place at rest at {:g} s",
                                    pairs_[e][0], pairs_[e][1], t),
                        "ends of a spring that are apart");
    }
    now_[e] = start_[e] * (length / apart_[e]);
  }
  return true;
}

}  // namespace bb
