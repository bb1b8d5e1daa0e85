// Kernels over the elements of one family: energies, gradients and Hessians, one element an item. The family is a
// struct of pointers with `width` vertices an element,
//   double value(const double* x, Index e)                                          J
//   ElementTerms<double, 3 width> terms(const double* x, Index e, Projection)       J, N, N/m
//   int vertex(int k, Index e)
// and, where a host takes several abreast, with the bits of terms(),
//   lanes, void terms_abreast(const double* x, Index first, Projection, TermsAbreast<double, lanes, width>& out)
#pragma once

#include <cstring>

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

/// How many a host takes abreast; 1: there is no such form.
template <class Elements>
constexpr int lanes_of() {
  if constexpr (requires { Elements::lanes; }) {
    return Elements::lanes;
  } else {
    return 1;
  }
}

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
  static constexpr int lanes = lanes_of<Elements>();
  void abreast(Index i) const requires(lanes > 1) {
    TermsAbreast<double, lanes, Elements::width> terms;
    elements.terms_abreast(x, piece.begin + i, Projection::none, terms);
    memcpy(energy + piece.begin + i, terms.energy, sizeof terms.energy);
    for (int c = 0; c < 3 * Elements::width; ++c) {
      memcpy(grad + c * piece.n + i, terms.grad[c], sizeof terms.grad[c]);
    }
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
  static constexpr int lanes = lanes_of<Elements>();
  void abreast(Index i) const requires(lanes > 1) {
    const Index e = piece.begin + i;
    const bool clamp = has_large_force(e);
    for (int lane = 1; lane < lanes; ++lane) {
      if (has_large_force(e + lane) == clamp) continue;
      for (int one = 0; one < lanes; ++one) (*this)(i + one);
      return;
    }
    for (int pass = 0; pass < (request.t > 0 ? 2 : 1); ++pass) {
      TermsAbreast<double, lanes, Elements::width> terms;
      elements.terms_abreast(x, e, clamp || pass == 1 ? Projection::psd : request.first, terms);
      double* out = hess + i;
      for (const auto& number : terms.hess) {
        for (int lane = 0; lane < lanes; ++lane) put(number[lane], pass == 0 ? 0 : request.t, out[lane]);
        out += piece.n;
      }
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
  /// t = 0: number; else what is there brought to it by t.
  BB_HD static void put(double number, double t, double& there) {
    there = t > 0 ? there + t * (number - there) : number;
  }
  BB_HD void store(const Mat<double, size, size>& m, Index i, double t) const {
    double* out = hess + i;
    for_each_lower_number(Elements::width, [&](int row, int column) {
      put(m(row, column), t, *out);
      out += piece.n;
    });
  }
};

}  // namespace bb::resident
