#include "core/model/bodies/plasticity.hpp"

#include <fmt/format.h>

#include <cmath>

namespace bb {

double Material::creep_rate(double own) const {
  constexpr double at_once = 1e300;  // 1/s: nothing is left after any step
  if (own > 0 || plasticity == 0) return own;
  return plasticity < 1 ? -std::log1p(-plasticity) / plasticity_step : at_once;
}

void check_plasticity(const Complaints& complain, const Material& m) {
  const auto refuse = [&](const char* key, double found, const char* allowed) {
    complain(std::string("/material/") + key, fmt::format("{}", found), allowed);
  };
  if (m.plasticity == 0) {
    if (m.plasticity_step != Material().plasticity_step)
      refuse("plasticity_step_s", m.plasticity_step, "nothing without plasticity");
    return;
  }
  if (m.membrane_creep > 0 || m.bending_creep > 0 || m.cloth_creep > 0) {
    refuse("plasticity", m.plasticity,
           "0 beside membrane_creep_per_s, bending_creep_per_s or cloth_creep_per_s: it is all three");
  }
  if (m.model == "none" && !m.hinges_bend() && !m.has_sides() && !m.has_diagonals()) {
    refuse("plasticity", m.plasticity,
           "0 without a membrane model, without bending and without springs of cloth: no rest shape follows");
  }
}

}  // namespace bb
