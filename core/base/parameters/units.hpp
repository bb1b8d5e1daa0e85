// What sizes a quantity of a unit may have: the one place that says so, for settings, scenes, materials and the parameters of
// registries.
#pragma once

#include <string_view>

namespace bb {

/// Wide enough for what cells, fibres and buildings are made of, and so narrow that products and squares of two of them stay
/// within double.
struct Sizes {
  double least, most;  // of a value that is not 0
};

/// Of a number of this unit. A number without any unit ("") has no bound.
Sizes sizes_of(std::string_view unit);

}  // namespace bb
