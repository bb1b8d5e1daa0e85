// Turns the inlined element template of a shape into the batch calls that the registry and the plugins share.
#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "barriers/shapes/gap_potential.hpp"
#include "core/barrier/shape.hpp"

namespace bb {

/// The batch call of shape struct S; `self` is not used. Cost O(n), allocates nothing.
template <class S, class T>
void shape_batch(void*, std::size_t n, const T* d, const T* d_hat, T* b, T* db, T* d2b) {
  for (std::size_t i = 0; i < n; ++i) {
    const ShapeTerms<T> terms = S::eval(d[i], d_hat[i]);
    b[i] = terms.b;
    db[i] = terms.db;
    d2b[i] = terms.d2b;
  }
}

/// The same of its potential.
template <class S, class T>
void potential_batch(void*, std::size_t n, const T* d, const T* d_hat, T* b, T* db, T* d2b) {
  for (std::size_t i = 0; i < n; ++i) {
    const ShapeTerms<T> terms = shapes::potential_terms<S>(d[i], d_hat[i]);
    b[i] = terms.b;
    db[i] = terms.db;
    d2b[i] = terms.d2b;
  }
}

template <class S>
Shape builtin_shape(std::string name, std::string doc) {
  Shape shape;
  shape.name = std::move(name);
  shape.doc = std::move(doc);
  shape.smoothness_at_d_hat = S::smoothness_at_d_hat;
  shape.infinite_at_zero = S::infinite_at_zero;
  shape.batch_double = &shape_batch<S, double>;
  shape.batch_float = &shape_batch<S, float>;
  if constexpr (shapes::HasPotential<S>) {
    shape.potential_double = &potential_batch<S, double>;
    shape.potential_float = &potential_batch<S, float>;
  }
  return shape;
}

}  // namespace bb
