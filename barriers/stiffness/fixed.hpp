// Stiffness policy `fixed`: one kappa (N/m) for every contact, one k_s for a strain limit (N/m; Pa in solids).
#pragma once

#include "core/barrier/stiffness_policy.hpp"
#include "core/math/host_device.hpp"

namespace bb {

struct Fixed {
  double stiffness = 0;  // N/m

  static constexpr const char* limit_doc =
      "kappa_e = k_s x rest area (of tetrahedra: solid_k_s_Pa x rest volume)";
  template <class List>
  static void describe(List& list) {
    if (list.of_limit()) {
      list.matched("k_s_N_per_m", &Fixed::stiffness, "N/m",
                   "stiffness; absent: the matching rule supplies it");
    } else {
      list.matched("kappa_N_per_m", &Fixed::stiffness, "N/m", "kappa; absent: the matching rule supplies it");
      list.published_constants();
    }
  }
  template <class Refuse>
  void check(Refuse&) const {}

  /// The stiffness times a factor: what the config requests is one number.
  Fixed times(double factor) const { return {factor * stiffness}; }
  double uniform_kappa() const { return stiffness; }
  template <class T>
  BB_HD KappaPartsOf<T> element_parts(const ElementSums<T>& sums, T, const StiffnessTime&) const {
    return {T(stiffness) * sums.measure, T(0)};
  }
};

}  // namespace bb
