// Rest shapes as columns that kernels read.
#pragma once

#include "core/energy/tetrahedron.hpp"
#include "core/energy/triangle_membrane.hpp"
#include "core/exec/kernel.hpp"

namespace bb {

/// Rest shapes of n triangles or tetrahedra. Rest: TriangleRest<double> or TetrahedronRest<double>.
template <class Rest>
struct RestColumnsOf;
template <template <class> class Rest>
struct RestColumnsOf<Rest<double>> {
  static constexpr int n_inverse = decltype(Rest<double>::dm_inv)::SizeAtCompileTime;

  const double* dm_inv;   // [4 or 9, n] 1/m, column-major entries
  const double* measure;  // [n] m^2 or m^3
  template <class T = double>
  BB_HD Rest<T> at(exec::Index e, exec::Index n) const {
    Rest<T>
        out;  // written in its place: numbers that are stored one by one and copied two by two wait for each other
    auto& [inverse, size] = out;
    for (int k = 0; k < n_inverse; ++k) inverse.data()[k] = static_cast<T>(dm_inv[k * n + e]);
    size = static_cast<T>(measure[e]);
    return out;
  }
};
using RestColumns = RestColumnsOf<TriangleRest<double>>;
using SolidRestColumns = RestColumnsOf<TetrahedronRest<double>>;

}  // namespace bb
