// Friction laws by name: what the config, eval and tests loop over; rows of friction have them as types (friction_list.hpp).
#pragma once

#include <string_view>

#include "core/base/parameters/registry.hpp"
#include "core/energy/friction_laws/profile.hpp"

namespace bb {

/// One line of friction_laws/registry.inc.
template <class T>
struct FrictionLaw {
  std::string_view name, doc;
  bool two_coefficients;  // whether it reads a static coefficient beside the kinetic one
  /// y >= 0: length of the slide, m.
  FrictionProfile<T> (*eval)(T y, const SlideScales<T>& of);
};

/// Every registered law, in the order of registry.inc. T: float or double.
template <class T>
const Registry<FrictionLaw<T>>& friction_laws_in();

/// Their names; those of laws with a static and a kinetic coefficient.
std::vector<std::string> friction_law_names();
std::vector<std::string> two_coefficient_laws();

}  // namespace bb
