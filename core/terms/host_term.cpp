// What most terms do alike: energies of fixed elements are compared one by one, those of elements that come
// and go only as sums.
#include "core/terms/host_term.hpp"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/math/parallel.hpp"

namespace bb {

std::size_t HostTerm::size() const {
  std::size_t n = 0;
  for (const TermFamily& family : families_) n += family.stencils.size();
  return n;
}

void HostTerm::compare_elements(const TermFamily& family, EnergyParts& out) {
  const std::vector<double>&from = family.local.energy, &to = family.trial_energy;
  const std::size_t start = out.size();
  out.resize(start + from.size());
  parallel_items(from.size(), block_items, [&](std::size_t e) {
    out[start + e] = {to[e] - from[e], std::abs(from[e]) + std::abs(to[e])};
  });
}

void HostTerm::change(const PositionsView&, const PositionsView&, EnergyParts& out) const {
  for (const TermFamily& family : families_) {
    if (fixed_stencils()) {
      compare_elements(family, out);
      continue;
    }
    const std::vector<double>&from = family.local.energy, &to = family.trial_energy;
    const std::size_t start = out.size();
    out.resize(start + from.size() + to.size());
    parallel_items(from.size(), block_items, [&](std::size_t e) {
      out[start + e] = {-from[e], std::abs(from[e])};
    });
    parallel_items(to.size(), block_items, [&](std::size_t e) {
      out[start + from.size() + e] = {to[e], std::abs(to[e])};
    });
  }
}

void HostTerm::take_energies() {
  for (TermFamily& family : families_) std::swap(family.local.energy, family.trial_energy);
}

void HostTerm::require_matrix() const {
  if (blocks_) return;
  throw std::logic_error("the term " + std::string(name()) +
                         " reads a matrix before set_matrix() has set where it is");
}

}  // namespace bb
