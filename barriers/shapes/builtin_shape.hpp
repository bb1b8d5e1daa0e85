// Turns the inlined element template of a shape into the batch calls that the registry and the plugins share.
#pragma once

#include <bit>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "barriers/shapes/shape_family.hpp"
#include "core/barrier/shape.hpp"
#include "core/barrier/shape_potential.hpp"

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

namespace shapes {

/// A shape with an exponent: eval(d, d_hat, a), and the exponents that are allowed.
template <class S>
concept HasExponent = requires {
  S::eval(1.0, 1.0, 1.0);
  S::least_exponent;
};

/// One whose pieces meet at gaps that the exponent gives: joints(a), for Shape::joints.
template <class S>
concept HasJoints = requires {
  S::joints(1.0);
};

template <class S>
std::vector<double> joints_of(double exponent) {
  const auto joints = S::joints(exponent);
  return {joints.begin(), joints.end()};
}

}  // namespace shapes

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
  if constexpr (shapes::HasJoints<S>) shape.joints = shapes::joints_of<S>(S::default_exponent);
  return shape;
}

/// shape_batch of the exponent whose bits `self` holds, so that copies of a shape own nothing.
template <class S, class T>
void exponent_batch(void* self, std::size_t n, const T* d, const T* d_hat, T* b, T* db, T* d2b) {
  const T a = static_cast<T>(std::bit_cast<double>(self));
  for (std::size_t i = 0; i < n; ++i) {
    const ShapeTerms<T> terms = S::eval(d[i], d_hat[i], a);
    b[i] = terms.b;
    db[i] = terms.db;
    d2b[i] = terms.d2b;
  }
}

/// The shape of another exponent, under the name it was requested by.
template <class S>
Shape member_of(Shape shape, std::string_view name, double exponent) {
  static_assert(sizeof(void*) == sizeof(double));
  shape.name = name;
  shape.batch_double = &exponent_batch<S, double>;
  shape.batch_float = &exponent_batch<S, float>;
  shape.self = std::bit_cast<void*>(exponent);
  shape.launches = nullptr;  // kernels are those of the usual exponent
  if constexpr (shapes::HasJoints<S>) shape.joints = shapes::joints_of<S>(exponent);
  return shape;
}

/// Null for a shape without an exponent.
template <class S>
const ShapeFamily* shape_family([[maybe_unused]] std::string_view name) {
  if constexpr (shapes::HasExponent<S>) {
    static const ShapeFamily family{name, S::least_exponent, S::most_exponent, S::default_exponent,
                                    &member_of<S>};
    return &family;
  } else {
    return nullptr;
  }
}

}  // namespace bb
