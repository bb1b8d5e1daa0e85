// Kernels over the elements of one family: energies, gradients and Hessians, one element an item. The family is a
// struct of pointers with `width` vertices an element,
//   double value(const double* x, Index e)                                          J
//   ElementTerms<double, 3 width> terms(const double* x, Index e, Projection)       J, N, N/m
//   int vertex(int k, Index e)
#pragma once

#include "core/energy/terms.hpp"
#include "core/exec/kernel.hpp"

namespace bb::resident {

using exec::Index;
using exec::Key;

/// Vertices of n elements as columns, and their points.
template <int W>
struct ElementVertices {
  static constexpr int width = W;
  const int* of;  // [W n] column k: vertex k of every element
  Index n;

  BB_HD int vertex(int k, Index e) const { return of[k * n + e]; }
  /// x: [3 n_vertices] m.
  BB_HD void points(const double* x, Index e, Vec3d (&out)[W]) const {
    for (int k = 0; k < W; ++k) {
      const double* p = x + 3 * static_cast<Index>(vertex(k, e));
      out[k] = Vec3d(p[0], p[1], p[2]);
    }
  }
};

/// Neighbouring elements of a family: what has local terms at a time.
struct Piece {
  Index begin, n;
};

/// Which Hessian of an element goes into the matrix: `first`; where t > 0, first + t (clamped - first); where a vertex
/// of the element has a force of at least `threshold`, the clamped one.
struct HessianRequest {
  Projection first = Projection::psd;
  double t = 0;
  double threshold = -1;          // N; below 0: no vertex is asked
  const double* force = nullptr;  // [n_vertices] N, read where there is a threshold
};

template <class Elements>
struct ElementValues {
  Elements elements;
  const double* x;  // [3 n_vertices] m
  double* energy;   // [n] J
  BB_HD void operator()(Index e) const { energy[e] = elements.value(x, e); }
};

/// Item i: element piece.begin + i.
template <class Elements>
struct ElementGradients {
  Elements elements;
  Piece piece;
  const double* x;
  double* energy;  // [n] J
  double* grad;    // [3 width, piece.n] N, a column a coordinate
  BB_HD void operator()(Index i) const {
    constexpr int size = 3 * Elements::width;
    const Index e = piece.begin + i;
    const ElementTerms<double, size> terms = elements.terms(x, e, Projection::none);
    energy[e] = terms.energy;
    for (int c = 0; c < size; ++c) grad[c * piece.n + i] = terms.grad[c];
  }
};

/// Item i: element piece.begin + i; its lower blocks (core/math/lower_blocks.hpp).
template <class Elements>
struct ElementHessians {
  Elements elements;
  Piece piece;
  HessianRequest request;
  const double* x;
  double* hess;  // [9 width (width + 1)/2, piece.n] N/m, a column a number

  BB_HD void operator()(Index i) const {
    const Index e = piece.begin + i;
    const bool clamp = has_large_force(e);
    for (int pass = 0; pass < (request.t > 0 ? 2 : 1); ++pass) {
      const Projection projection = clamp || pass == 1 ? Projection::psd : request.first;
      store(elements.terms(x, e, projection).hess, i, pass == 0 ? 0 : request.t);
    }
  }

 private:
  static constexpr int size = 3 * Elements::width;

  BB_HD bool has_large_force(Index e) const {
    bool large = false;
    for (int k = 0; k < Elements::width && request.threshold >= 0; ++k) {
      large = large || request.force[elements.vertex(k, e)] >= request.threshold;
    }
    return large;
  }
  /// t = 0: the numbers of m; else what is there brought to m by t.
  BB_HD void store(const Mat<double, size, size>& m, Index i, double t) const {
    double* out = hess + i;
    for (int b = 0; b < Elements::width; ++b) {
      for (int a = b; a < Elements::width; ++a) {
        for (int c = 0; c < 3; ++c) {
          for (int r = 0; r < 3; ++r) {
            const double number = m(3 * a + r, 3 * b + c);
            *out = t > 0 ? *out + t * (number - *out) : number;
            out += piece.n;
          }
        }
      }
    }
  }
};

}  // namespace bb::resident
