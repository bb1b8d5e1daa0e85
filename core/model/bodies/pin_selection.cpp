#include "core/model/bodies/pin_selection.hpp"

#include <algorithm>

#include "core/model/bodies/weights.hpp"

namespace bb {

namespace {

/// Vertices with a weight of at least the threshold; without one, and where nothing else selects, those with a weight in any group.
void select_by_weights(const PinSpec& spec, const BodySpec& body, std::vector<int>& selected) {
  const bool alone = selected.empty() && !spec.box && !spec.top_row && !spec.all;
  if (spec.mix.empty() || (!spec.threshold && !alone)) return;
  const WeightMix mix = mix_of(body, spec.mix);
  const auto any_group = [&mix](std::size_t v) {
    return std::any_of(mix.layers.begin(), mix.layers.end(),
                       [v](const WeightLayer& layer) { return layer.weight[v] > 0; });
  };
  const std::vector<double> weights = mix.at(0);
  for (std::size_t v = 0; v < weights.size(); ++v) {
    if (spec.threshold ? weights[v] >= *spec.threshold : any_group(v))
      selected.push_back(static_cast<int>(v));
  }
}

}  // namespace

std::vector<int> select_vertices(const PinSpec& spec, const BodySpec& body, const Positions& start,
                                 bool planar) {
  std::vector<int> selected = spec.indices;
  select_by_weights(spec, body, selected);
  const int up = planar ? 1 : 2;
  const double top = start.cols() > 0 ? start.row(up).maxCoeff() : 0;
  for (int v = 0; v < static_cast<int>(start.cols()); ++v) {
    const auto x = start.col(v).array();
    const bool in_box =
        spec.box && (x >= (*spec.box)[0].array()).all() && (x <= (*spec.box)[1].array()).all();
    if (spec.all || in_box || (spec.top_row && x[up] == top)) selected.push_back(v);
  }
  std::sort(selected.begin(), selected.end());
  selected.erase(std::unique(selected.begin(), selected.end()), selected.end());
  return selected;
}

}  // namespace bb
