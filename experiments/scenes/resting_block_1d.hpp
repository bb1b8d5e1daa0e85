// The closed form behind the scene resting_block_1d.
#pragma once

#include "core/parameters/parameter.hpp"

namespace bb {

/// Load of each of the three contacts at rest, N: a third of the weight. All vertices hang at one
/// height, so no element is strained and the gap d solves kappa |b'(d)| = load; each contact then has
/// stiffness kappa b''(d).
double resting_block_load(const ParameterMap& parameters);

}  // namespace bb
