// Whether surfaces that touch exactly also pass through each other. Signs of exactly touching pairs are zero and say
// neither. A touch is only a touch when an infinitely small displacement of one surface takes the pairs apart without
// any of them crossing; a passage keeps some pair crossing whatever small displacement is made.
#pragma once

#include <vector>

#include "core/audit/surface.hpp"

namespace bb::audit {

/// Of pairs that touch (edge and triangle; planar: edge and edge): those for which no displacement was found, in
/// order. The primitives of all pairs that hang together by their vertices are one patch; two patches that touch are
/// displaced against each other along 26 (planar: 8) directions, and by shrinking and growing one of them about its
/// middle. Displacements are infinitesimal: signs are those of polynomials in a small positive number, in integers.
/// A patch that touches itself has no displacement. Cost: up to 28 times some tens of microseconds a pair.
std::vector<PairName> inseparable(const AuditMesh& mesh, const Positions& x, std::vector<PairName> touching);

}  // namespace bb::audit
