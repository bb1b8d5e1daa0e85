// What restitution is made of, on the host and on an executor.
#pragma once

#include "core/energy/restitution.hpp"

namespace bb {

constexpr double least_meeting_speed =
    1e-2;  // m/s; pairs that meet slower are damped as those that meet with it

/// What a side, a body or an obstacle, asks for, in units of 1 over the speed at which a pair met.
template <class Side>
double damping_of(const Side& side) {
  return restitution_damping(side.restitution.value_or(1));
}

}  // namespace bb
