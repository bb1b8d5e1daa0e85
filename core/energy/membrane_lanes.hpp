// Four membrane triangles of the model corotational side by side.
#pragma once

#include "core/energy/terms.hpp"
#include "core/energy/triangle_membrane.hpp"

namespace bb {

constexpr int membrane_lanes = 4;

/// What membrane_terms() asks of each of them. Host only.
template <class T>
struct TrianglesAbreast {
  T x[9][membrane_lanes];                                  // m, point-major
  T dm_inv[4][membrane_lanes];                             // 1/m, column-major
  T area[membrane_lanes];                                  // m^2
  T lame_mu[membrane_lanes], lame_lambda[membrane_lanes];  // N/m

  void set(int lane, const Vec<T, 3> (&points)[3], const TriangleRest<T>& rest, T mu, T lambda) {
    for (int i = 0; i < 3; ++i) {
      for (int c = 0; c < 3; ++c) x[3 * i + c][lane] = points[i][c];
    }
    for (int k = 0; k < 4; ++k) dm_inv[k][lane] = rest.dm_inv.data()[k];
    area[lane] = rest.area, lame_mu[lane] = mu, lame_lambda[lane] = lambda;
  }
};

/// The energy (J) of each in space, with the bits of membrane_value(). Of float and double.
template <class T>
void corotational_values_abreast(const TrianglesAbreast<T>& triangles, T (&energy)[membrane_lanes]);

/// The terms of each in space, with the bits of membrane_terms(). Of float and double.
template <class T>
void corotational_terms_abreast(const TrianglesAbreast<T>& triangles, Projection projection,
                                TermsAbreast<T, membrane_lanes, 3>& out);

}  // namespace bb
