// Where the ends of the spectrum live: an eigenvalue as a sum over the elements of all terms, its eigenvector as a sum
// over bodies and vertices.
#pragma once

#include <vector>

#include "core/base/record/trace_row.hpp"
#include "core/linear/end_vectors.hpp"
#include "core/newton/newton_system.hpp"

namespace bb {

/// Both ends of the clamped matrix of a set of terms, smallest first. lambda = u^T A u = sum over elements of u_e^T H_e
/// u_e, u the unscaled eigenvector, so every element has a part of it.
/// @param ends  of system.clamped(set), which has to be the last call of `system`
/// Errors: none.   Cost: O(elements).
std::vector<SpectrumEnd> describe_ends(Diagnosis& system, TermSet set, const EndVectors& ends);

}  // namespace bb
