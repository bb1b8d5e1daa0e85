// What most terms do alike: energies of fixed elements are compared one by one, those of elements that come
// and go only as sums.
#include "core/terms/term.hpp"

#include <cmath>
#include <utility>

namespace bb {

std::size_t Term::size() const {
  std::size_t n = 0;
  for (const TermFamily& family : families_) n += family.stencils.size();
  return n;
}

void Term::change(const Positions&, const Positions&, EnergyParts& out) const {
  for (const TermFamily& family : families_) {
    const std::vector<double>&from = family.local.energy, &to = family.trial_energy;
    if (fixed_stencils()) {
      for (std::size_t e = 0; e < from.size(); ++e) {
        out.push_back({to[e] - from[e], std::abs(from[e]) + std::abs(to[e])});
      }
      continue;
    }
    for (const double energy : from) out.push_back({-energy, std::abs(energy)});
    for (const double energy : to) out.push_back({energy, std::abs(energy)});
  }
}

void Term::accept(PhaseClock&) {
  for (TermFamily& family : families_) std::swap(family.local.energy, family.trial_energy);
}

}  // namespace bb
