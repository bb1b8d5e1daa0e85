// Four membrane triangles side by side, of every model, and their stretches.
#pragma once

#include "core/energy/terms.hpp"
#include "core/energy/triangle_membrane.hpp"

namespace bb {

constexpr int membrane_lanes = 4;

/// What membrane_terms() needs of each of them. Host only. Without Lame parameters: what deformation_gradient() needs.
template <class T>
struct TrianglesAbreast {
  T x[9][membrane_lanes];                                  // m, point-major
  T dm_inv[4][membrane_lanes];                             // 1/m, column-major
  T area[membrane_lanes];                                  // m^2
  T lame_mu[membrane_lanes], lame_lambda[membrane_lanes];  // N/m

  void set(int lane, const Vec<T, 3> (&points)[3], const TriangleRest<T>& rest) {
    for (int i = 0; i < 3; ++i) {
      for (int c = 0; c < 3; ++c) x[3 * i + c][lane] = points[i][c];
    }
    for (int k = 0; k < 4; ++k) dm_inv[k][lane] = rest.dm_inv.data()[k];
    area[lane] = rest.area;
  }
  void set(int lane, const Vec<T, 3> (&points)[3], const TriangleRest<T>& rest, T mu, T lambda) {
    set(lane, points, rest);
    lame_mu[lane] = mu, lame_lambda[lane] = lambda;
  }
};

/// The energy (J) of each in space, with the bits of membrane_value(). Of every line of registry.inc, in float and double.
template <class Model, class T>
void membrane_values_abreast(const TrianglesAbreast<T>& triangles, T (&energy)[membrane_lanes]);

/// The terms of each in space, with the bits of membrane_terms(). Likewise.
template <class Model, class T>
void membrane_terms_abreast(const TrianglesAbreast<T>& triangles, Projection projection,
                            TermsAbreast<T, membrane_lanes, 3>& out);

/// The singular values of F of each in space, the larger one first, with the bits of svd_3x2(). Of float and double.
template <class T>
void stretches_abreast(const TrianglesAbreast<T>& triangles, T (&sigma)[2][membrane_lanes]);

}  // namespace bb
