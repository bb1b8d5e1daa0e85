// Triangles under a pressure from within, seen from the centre of their body at the start of the step.
#pragma once

#include "core/energy/inflation.hpp"
#include "core/energy/families/element_kernels.hpp"
#include "core/resident/elements/load_kernels.hpp"

namespace bb::resident {

struct Inflated : ElementVertices<3> {
  const double* pressure;  // [n] Pa, without what follows keys
  const int* key;          // [n] into factor, -1: constant
  const double* factor;    // of the step
  const int* body;         // [n] into centre
  const double* centre;    // [3 bodies] m

  BB_HD double pressure_of(Index e) const { return key[e] < 0 ? pressure[e] : pressure[e] * factor[key[e]]; }
  BB_HD void off_centre(const double* x, Index e, Vec3d (&out)[3]) const {
    points(x, e, out);
    const Vec3d from = point_at(centre, body[e]);
    for (int k = 0; k < 3; ++k) out[k] -= from;
  }
  BB_HD double value(const double* x, Index e) const {
    Vec3d p[3];
    off_centre(x, e, p);
    return -pressure_of(e) * volume_below<double>(p[0], p[1], p[2]);
  }
  BB_HD ElementTerms<double, 9> terms(const double* x, Index e, Projection projection) const {
    Vec3d p[3];
    off_centre(x, e, p);
    return inflation_terms<double>(p, pressure_of(e), projection);
  }
};

/// Neighbouring vertices.
struct VertexRange {
  int first, n;
};

/// centre of body b: the mean of its vertices, a tree over 256 strided sums.
struct BodyCentres {
  struct Shared {
    double sum[3][exec::block_threads];
  };
  const VertexRange* range;
  const double* x;  // [3 n_vertices] m
  double* centre;   // [3 bodies] m
  template <class Block>
  BB_HD void operator()(Block& block, Shared& shared, Index b) const {
    const VertexRange of = range[b];
    block.threads([&](int t) {
      double sum[3] = {0, 0, 0};
      for (int v = t; v < of.n; v += exec::block_threads) {
        for (int c = 0; c < 3; ++c) sum[c] += x[3 * static_cast<Index>(of.first + v) + c];
      }
      for (int c = 0; c < 3; ++c) shared.sum[c][t] = sum[c];
    });
    for (int c = 0; c < 3; ++c) exec::fold(block, shared.sum[c], exec::block_threads);
    block.threads(3, [&](int t) { centre[3 * b + t] = shared.sum[t][0] / of.n; });
  }
};

}  // namespace bb::resident
