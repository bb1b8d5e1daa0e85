// The sums from which policies make the kappa of one item: of a contact, or of a strain-limited element. Element math,
// the same for hosts and kernels; no policy is named here.
#pragma once

#include "core/math/host_device.hpp"

namespace bb {

/// Length of the time step and inertia weight: inertia is M/(c dt^2). c = 0 is quasi-static and has none.
struct StiffnessTime {
  double dt = 0;  // s
  double c = 1;   // 1

  /// What a mass part w^T M w becomes in the matrix of a step: over c dt^2; 0 without inertia.
  template <class T>
  BB_HD T inertia(T mass) const {
    return c > 0 ? mass / T(c * dt * dt) : T(0);
  }
};

/// The smallest gap at which a policy is evaluated: floor in units of the width of the barrier.
template <class T>
BB_HD T floored_gap(T gap, double floor, T width) {
  const T least = T(floor) * width;
  return gap < least ? least : gap;
}

/// Of one contact, w the stacked w_i n over its free vertices.
template <class T>
struct ContactSums {
  T mass = T(0);     // w^T M w, kg
  T elastic = T(0);  // w^T H w, N/m
  T w_sq = T(0);     // w^T w, 1
};

/// Of one limited triangle or tetrahedron, w_i = x_i - centroid at the start of the step.
template <class T>
struct ElementSums {
  T mass = T(0);          // w^T M w, kg m^2
  T elastic = T(0);       // w^T H w, J
  T element_mass = T(0);  // kg
  T measure = T(0);       // m^2 or m^3, at rest
};

/// A matrix in memory, column-major with a leading dimension, as a function of row and column.
template <class T>
struct ColumnMajor {
  const T* values;
  int ld;
  BB_HD T operator()(int row, int column) const { return values[column * ld + row]; }
};

/// @param n_free   N, 1..4            @param weight  [N] w_i, not all 0
/// @param normal   [3] not 0          @param mass    [N] kg; null: w^T M w is not requested
/// @param hessian  hessian(row, column) with both below 3N, N/m; read when with_hessian
/// Errors: none. Host-device. Cost: O(N^2), allocates nothing.
template <class T, class Hessian>
BB_HD ContactSums<T> contact_sums(int n_free, const T* weight, const T* normal, const T* mass,
                                  const Hessian& hessian, bool with_hessian) {
  ContactSums<T> sums;
  const T n_sq = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
  for (int i = 0; i < n_free; ++i) {
    const T wi_sq = weight[i] * weight[i];
    sums.w_sq += wi_sq * n_sq;
    if (mass) sums.mass += wi_sq * n_sq * mass[i];
  }
  if (!with_hessian) return sums;
  for (int j = 0; j < 3 * n_free; ++j) {
    const T wj = weight[j / 3] * normal[j % 3];
    T column = T(0);
    for (int i = 0; i < 3 * n_free; ++i) column += weight[i / 3] * normal[i % 3] * hessian(i, j);
    sums.elastic += column * wj;
  }
  return sums;
}

}  // namespace bb
