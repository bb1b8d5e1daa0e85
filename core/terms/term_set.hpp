// Groups of terms, and sets of groups: H is the set `elastic`, a stage of the diagnosis is everything
// without some groups.
#pragma once

#include "core/base/record/phase_times.hpp"

namespace bb {

enum class TermGroup : unsigned {
  load = 1,      // inertia and external forces
  elastic = 2,   // what H holds: what stiffness policies read
  limit = 4,     // limits of deformation
  contact = 8,   // what keeps surfaces apart
  friction = 16  // friction and restitution
};

/// What linearising elements that stay is charged to.
constexpr Phase phase_of(TermGroup group) {
  return group == TermGroup::load ? Phase::assembly : Phase::elastic;
}

class TermSet {
 public:
  constexpr TermSet() = default;
  constexpr TermSet(TermGroup group) : bits_(static_cast<unsigned>(group)) {}
  static constexpr TermSet all() { return TermSet(~0U); }

  constexpr TermSet operator|(TermSet other) const { return TermSet(bits_ | other.bits_); }
  constexpr TermSet without(TermSet other) const { return TermSet(bits_ & ~other.bits_); }
  constexpr bool has(TermGroup group) const { return (bits_ & static_cast<unsigned>(group)) != 0; }
  constexpr bool operator==(const TermSet&) const = default;

 private:
  constexpr explicit TermSet(unsigned bits) : bits_(bits) {}
  unsigned bits_ = 0;
};

}  // namespace bb
