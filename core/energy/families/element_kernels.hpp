// Kernels over the elements of one kind: energies, gradients and Hessians, one element an item. A kind is a struct of
// pointers with `width` vertices an element,
//   double value(const double* x, Index e)                                          J
//   ElementTerms<double, 3 width> terms(const double* x, Index e, Projection)       J, N, N/m
//   int vertex(int k, Index e)
// where a host may choose the scalar T, those of the first two as templates of it; where energies have cusps, bool is_cusp<T>(x, e);
// where a change between two states has a closed form, which does not cancel as a difference of energies does,
//   ValueChange<double> change(const double* x0, const double* x1, Index e)         J
// where energy and derivatives of many elements are 0, whatever x is, bool is_slack<T>(Index e);
// where there is no Hessian, linear = true; where elements are all vertices, in their order, every_vertex = true;
// where a host takes several abreast, with the bits of terms(),
//   lanes, void terms_abreast<T>(const double* x, Index first, Projection, TermsAbreast<T, lanes, width>& out)
//   and, where it has that too, void values_abreast<T>(const double* x, Index first, T (&energy)[lanes]), J
#pragma once

#include <cstring>

#include "core/energy/element_lanes.hpp"
#include "core/energy/families/pieces.hpp"
#include "core/energy/terms.hpp"
#include "core/math/precision.hpp"

namespace bb {

/// Vertices of n elements as columns, and their points.
template <int W>
struct ElementVertices {
  static constexpr int width = W;
  const int* of;  // [W n] column k: vertex k of every element
  exec::Index n;

  BB_HD int vertex(int k, exec::Index e) const { return of[k * n + e]; }
  /// x: [3 n_vertices] m.
  template <class T>
  BB_HD void points(const double* x, exec::Index e, Vec<T, 3> (&out)[W]) const {
    for (int k = 0; k < W; ++k) {
      const double* p = x + 3 * static_cast<exec::Index>(vertex(k, e));
      out[k] = Vec<T, 3>(static_cast<T>(p[0]), static_cast<T>(p[1]), static_cast<T>(p[2]));
    }
  }
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

/// What a kind may have beside values and terms. Without HasScalars it is computed in double.
template <class Elements>
concept HasScalars = requires(const Elements& of, const double* x) {
  of.template value<float>(x, exec::Index{});
};
template <class Elements>
concept HasCusps = requires(const Elements& of, const double* x) {
  of.template is_cusp<double>(x, exec::Index{});
};
template <class Elements>
concept MayBeSlack = requires(const Elements& of) {
  of.template is_slack<double>(exec::Index{});
};
template <class Elements>
concept HasChange = requires(const Elements& of, const double* x) {
  of.change(x, x, exec::Index{});
};
template <class Elements>
concept HasLaneValues = requires(const Elements& of, const double* x, double (&energy)[4]) {
  of.template values_abreast<double>(x, exec::Index{}, energy);
};
template <class Elements>
concept IsLinear = requires {
  requires Elements::linear;
};
template <class Elements>
concept IsEveryVertex = requires {
  requires Elements::every_vertex;
};

/// Elements that a host thread takes at least: an energy costs a decomposition or a logarithm.
constexpr exec::Index elements_of_a_thread = 64;

/// T: the scalar that it is computed in; a card has double alone.
template <class Elements, class T = double>
struct ElementValues {
  static constexpr exec::Index grain = elements_of_a_thread;
  Elements elements;
  const double* x;  // [3 n_vertices] m
  double* energy;   // [n] J
  BB_HD void operator()(exec::Index e) const {
    if constexpr (std::is_same_v<T, double>) {
      energy[e] = elements.value(x, e);
    } else {
      energy[e] = elements.template value<T>(x, e);
    }
  }
  static constexpr int lanes = lanes_of<Elements>();
  void abreast(exec::Index first) const requires HasLaneValues<Elements> {
    T of_four[lanes];
    elements.values_abreast(x, first, of_four);
    for (int lane = 0; lane < lanes; ++lane) energy[first + lane] = of_four[lane];
  }
};

/// The local terms of an element side by side, as an assembly in the host's cache reads them. Of a host alone.
template <class Elements, class T>
struct ElementLocalTerms {
  static constexpr exec::Index grain = elements_of_a_thread;
  Elements elements;
  Projection projection;
  PassParts parts;
  const double* x;
  double* energy;  // [n] J
  double* grad;    // [3 width n] N, element by element
  double* hess;    // [9 width (width + 1)/2 n] N/m, lower blocks, element by element

  void operator()(exec::Index e) const {
    if constexpr (MayBeSlack<Elements>) {
      if (elements.template is_slack<T>(e)) return store_zeros(e);
    }
    const ElementTerms<T, size> terms = terms_of(e);
    if (parts.values) {
      energy[e] = terms.energy;
      for (int c = 0; c < size; ++c) grad[size * e + c] = terms.grad[c];
    }
    if (!parts.hessians) return;
    store_lower_blocks(Elements::width, terms.hess, hess + numbers * e,
                       [](T entry) -> double { return entry; });
  }
  static constexpr int lanes = lanes_of<Elements>();
  void abreast(exec::Index first) const requires(lanes > 1) {
    TermsAbreast<T, lanes, Elements::width> terms;
    elements.terms_abreast(x, first, projection, terms);
    if (parts.values) {
      for (int lane = 0; lane < lanes; ++lane) energy[first + lane] = terms.energy[lane];
      store_by_element(terms.grad, size, size, grad + size * first);
    }
    if (parts.hessians) store_by_element(terms.hess, numbers, numbers, hess + numbers * first);
  }

 private:
  static constexpr int size = 3 * Elements::width;
  static constexpr exec::Index numbers = n_lower_numbers(Elements::width);
  void store_zeros(exec::Index e) const {
    if (parts.values) {
      energy[e] = 0;
      memset(grad + size * e, 0, sizeof(double) * size);
    }
    if (parts.hessians) memset(hess + numbers * e, 0, sizeof(double) * numbers);
  }
  ElementTerms<T, size> terms_of(exec::Index e) const {
    if constexpr (HasScalars<Elements>) {
      return elements.template terms<T>(x, e, projection);
    } else {
      return elements.terms(x, e, projection);
    }
  }
};

/// Changes from x0 to x1 in closed form; the numbers of element e are at stride e.
template <class Elements>
struct ElementChanges {
  Elements elements;
  const double *x0, *x1;
  double *change, *magnitude;  // J
  exec::Index stride;
  BB_HD void operator()(exec::Index e) const {
    const auto part = elements.change(x0, x1, e);
    change[stride * e] = part.change, magnitude[stride * e] = part.magnitude;
  }
};

/// Item i: element piece.begin + i.
template <class Elements>
struct ElementGradients {
  static constexpr exec::Index grain = elements_of_a_thread;
  Elements elements;
  Piece piece;
  const double* x;
  double* energy;  // [n] J
  double* grad;    // [3 width, piece.n] N, a column a coordinate
  BB_HD void operator()(exec::Index i) const {
    constexpr int size = 3 * Elements::width;
    const exec::Index e = piece.begin + i;
    const ElementTerms<double, size> terms = elements.terms(x, e, Projection::none);
    energy[e] = terms.energy;
    for (int c = 0; c < size; ++c) grad[c * piece.n + i] = terms.grad[c];
  }
  static constexpr int lanes = lanes_of<Elements>();
  void abreast(exec::Index i) const requires(lanes > 1) {
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
  static constexpr exec::Index grain = elements_of_a_thread;
  Elements elements;
  Piece piece;
  HessianRequest request;
  const double* x;
  double* hess;  // [9 width (width + 1)/2, piece.n] N/m, a column a number

  BB_HD void operator()(exec::Index i) const {
    const exec::Index e = piece.begin + i;
    const bool clamp = has_large_force(e);
    for (int pass = 0; pass < (request.t > 0 ? 2 : 1); ++pass) {
      const Projection projection = clamp || pass == 1 ? Projection::psd : request.first;
      store(elements.terms(x, e, projection).hess, i, pass == 0 ? 0 : request.t);
    }
  }
  static constexpr int lanes = lanes_of<Elements>();
  void abreast(exec::Index i) const requires(lanes > 1) {
    const exec::Index e = piece.begin + i;
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

  BB_HD bool has_large_force(exec::Index e) const {
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
  BB_HD void store(const Mat<double, size, size>& m, exec::Index i, double t) const {
    double* out = hess + i;
    for_each_lower_number(Elements::width, [&](int row, int column) {
      put(m(row, column), t, *out);
      out += piece.n;
    });
  }
};

}  // namespace bb
