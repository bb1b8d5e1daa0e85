#include "core/model/bodies/pin_selection.hpp"

#include <algorithm>

namespace bb {

std::vector<int> select_vertices(const PinSpec& spec, const Positions& start, bool planar) {
  std::vector<int> selected = spec.indices;
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
