// Energies that belong to single vertices: inertia, the work of a given force, and what pulls a vertex to a place.
#pragma once

#include <cmath>

#include "core/math/types.hpp"

namespace bb {

/// How an energy changes between two states, J; rounding noise is some multiple of eps times the magnitude.
template <class T>
struct ValueChange {
  T change, magnitude;
};

/// Weight of a vertex of mass m (kg) under inertia, m/(c h^2), N/m; 0 when quasi-static (c = 0). Host-device.
template <class T>
BB_HD T inertia_weight(T mass, T c, T dt) {
  return c == T(0) ? T(0) : mass / (c * dt * dt);
}

/// 1/2 weight |off|^2, J; off: from the predicted position, m. Exactly 0 without weight, wherever the vertex is.
template <class T>
BB_HD T inertia_value(T weight, const Vec<T, 3>& off) {
  return weight == T(0) ? T(0) : T(0.5) * weight * off.squaredNorm();
}

/// Its change from `from` to `to`, both off the prediction, step = to - from: a square of differences, not a
/// difference of squares.
template <class T>
BB_HD ValueChange<T> inertia_change(T weight, const Vec<T, 3>& from, const Vec<T, 3>& to,
                                    const Vec<T, 3>& step) {
  if (weight == T(0)) return {T(0), T(0)};
  return {T(0.5) * weight * step.dot(from + to), T(0.5) * weight * (from.squaredNorm() + to.squaredNorm())};
}

/// Weight force of a vertex, N. gravity in m/s^2; load_factor: the part of it that acts.
template <class T>
BB_HD Vec<T, 3> weight_force(T load_factor, T mass, const Vec<T, 3>& gravity) {
  return (load_factor * mass) * gravity;
}

/// Change of -force . x along `step` (m).
template <class T>
BB_HD ValueChange<T> work_change(const Vec<T, 3>& force, const Vec<T, 3>& step) {
  using std::abs;
  const T work = force.dot(step);
  return {-work, abs(work)};
}

// Of 1/2 off^T K off: off from a place (m), K symmetric without negative eigenvalues (N/m).

/// J.
template <class T>
BB_HD T quadratic_value(const Mat<T, 3, 3>& k, const Vec<T, 3>& off) {
  const Vec<T, 3> force = k * off;
  return T(0.5) * off.dot(force);
}

/// Its change from `from` to `to`, step = to - from: a square of differences, not a difference of squares.
template <class T>
BB_HD ValueChange<T> quadratic_change(const Mat<T, 3, 3>& k, const Vec<T, 3>& from, const Vec<T, 3>& to,
                                      const Vec<T, 3>& step) {
  const Vec<T, 3> sum = from + to, along = k * sum, k_from = k * from, k_to = k * to;
  return {T(0.5) * step.dot(along), T(0.5) * (from.dot(k_from) + to.dot(k_to))};
}

}  // namespace bb
