// Creep of a rest shape: a deviation beyond a dead zone decays, since the rest shape follows (docs/theory/incremental-potential.md, Creep).
#pragma once

#include <cmath>

#include "core/math/exp.hpp"
#include "core/math/host_device.hpp"

namespace bb {

/// What is left of a deviation (rad, or 1) after a time in which the excess over `yield` >= 0 decays to the part `kept` in [0, 1],
/// which is e^(-rate dt): itself within the dead zone |deviation| <= yield, else its sign times yield + kept (|deviation| - yield).
/// Exponential creep beyond a dead zone, as the newer code of Ando's solver has it.   Host-device: yes. Total.
template <class T>
BB_HD T crept(T deviation, T yield, T kept) {
  using std::abs;
  const T excess = abs(deviation) - yield;
  if (!(excess > T(0))) return deviation;
  const T left = yield + kept * excess;
  return deviation < T(0) ? -left : left;
}

/// The part of an excess that is left after dt (s) at `rate` (1/s).
BB_HD inline double kept_after(double rate, double dt) { return elementary::exp(-rate * dt); }

}  // namespace bb
