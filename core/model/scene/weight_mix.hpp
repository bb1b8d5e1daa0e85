// Weights of vertices between 0 and 1, mixed of layers whose influences may change over time.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace bb {

/// Influence of a layer at a time.
struct InfluenceKey {
  double time = 0;   // s
  double value = 1;  // in [-1, 1]
};

struct WeightLayer {
  std::vector<double> weight;      // [n] in [0, 1]
  double influence = 1;            // in [-1, 1]
  std::vector<InfluenceKey> keys;  // of the influence, instead; empty: constant

  double influence_at(double t) const;
};

/// The sum of its layers times their influences, cut off at 0 and 1.
struct WeightMix {
  std::vector<WeightLayer> layers;  // all of the same length

  bool given() const { return !layers.empty(); }
  /// [n] at the time t (s). Requires given().
  std::vector<double> at(double t) const;
};

/// The mean over vertices of an element, numbered as the weights are.
template <std::size_t W>
double mean_weight(const std::vector<double>& weights, const std::array<int, W>& vertices, int first = 0) {
  double sum = 0;
  for (const int v : vertices) sum += weights[static_cast<std::size_t>(v - first)];
  return sum / W;
}

}  // namespace bb
