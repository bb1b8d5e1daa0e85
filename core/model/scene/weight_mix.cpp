#include "core/model/scene/weight_mix.hpp"

#include <algorithm>

#include "core/model/scene/motion.hpp"

namespace bb {

double WeightLayer::influence_at(double t) const { return keys.empty() ? influence : value_at(keys, t); }

std::vector<double> WeightMix::at(double t) const {
  std::vector<double> out(layers.front().weight.size(), 0.0);
  for (const WeightLayer& layer : layers) {
    const double influence = layer.influence_at(t);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += influence * layer.weight[i];
  }
  for (double& w : out) w = std::clamp(w, 0.0, 1.0);
  return out;
}

}  // namespace bb
