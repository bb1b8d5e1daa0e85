// How E changes from one state to another.
#pragma once

namespace bb {

struct EnergyChange {
  double change = 0;     // E(trial) - E(iterate), J
  double magnitude = 0;  // sum of |parts|, J: rounding noise is some multiple of eps times this
};

}  // namespace bb
