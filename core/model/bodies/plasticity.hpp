// Plasticity of a material: one value for the rates at which its rest shapes follow. Private to core/model/bodies.
#pragma once

#include "core/model/bodies/body_spec.hpp"
#include "core/model/bodies/complaints.hpp"

namespace bb {

/// A rest shape that follows has one rate, and something that it is of.
void check_plasticity(const Complaints& complain, const Material& m);

}  // namespace bb
