// What the pipeline knows of a barrier shape: one batch call. The shapes themselves live in barriers/shapes/.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/math/device_code.hpp"
#include "core/math/host_device.hpp"

namespace bb {

/// b(d; d_hat) and its derivatives in the unsquared gap d, for kappa = 1. Exactly 0 for d >= d_hat.
template <class T>
struct ShapeTerms {
  T b;    // m^2
  T db;   // m
  T d2b;  // 1
};

/// Batch evaluation over columns: n gaps d > 0 (m) with their activation distances d_hat (m).
template <class T>
using ShapeBatch = void (*)(void* self, std::size_t n, const T* d, const T* d_hat, T* b, T* db, T* d2b);

struct ShapeLaunches;  // launches.hpp

/// A shape as the registry hands it out; built-ins and plugins look the same. `self` is null for built-ins.
struct Shape {
  std::string name;
  std::string doc;
  int smoothness_at_d_hat = 0;    // number of continuous derivatives at d = d_hat
  bool infinite_at_zero = false;  // b -> infinity as d -> 0
  ShapeBatch<double> batch_double = nullptr;
  ShapeBatch<float> batch_float = nullptr;
  /// d_hat^2 psi and its derivatives in d, psi the potential of b'/d^2: psi' = b'/d^2, 0 from d_hat on. So
  /// (kappa/d_hat^2) times it is the energy of the force (kappa/d^2) b', and infinite at 0. Null: no closed form.
  ShapeBatch<double> potential_double = nullptr;
  ShapeBatch<float> potential_float = nullptr;
  void* self = nullptr;
  const ShapeLaunches* launches = nullptr;  // of a shape that is a kernel of the program
  /// Of a shape that is no kernel of the program: its kernel (core/contact/executor/given_shape.hpp), made when it is
  /// requested and kept as long as the process. layout: given_shape_layout of the program. Null: there is none.
  /// Errors: ConfigError.
  const DeviceCode& (*device_code)(const Shape&, std::uint64_t layout) = nullptr;
  /// Where a shape that is put together of formulas changes from one to the next: its argument in units of that of d_hat,
  /// falling. Empty: one formula, or pieces that meet at 1/2.
  std::vector<double> joints = {};
};

/// What the shape is evaluated on; part of a formulation's identity (docs/theory/barriers.md).
///   gap: b = f(d; d_hat).   squared_gap: b = f(d^2; d_hat^2) / d_hat^2, derivatives in d.
enum class Argument { gap, squared_gap };

/// A shape with its argument: the function that the pipeline, `eval` and the plots all call.
struct BarrierFunction {
  Shape shape;
  Argument argument = Argument::gap;
  /// As the article's own code does (step solver article_literal, argument gap only): an unbounded shape is
  /// evaluated at max(d, 1e-10), a bounded one by its formula below contact too, its curvature 0 for d <= 0.
  bool literal = false;
  /// Columns of doubles are narrowed to float, evaluated so, and widened again (docs/reference/arithmetic.md, Precision). Requires
  /// batch_float.
  bool in_float = false;

  /// Terms of n rows. Cost O(n), allocates nothing. Errors: none, total for d > 0, d_hat > 0; literal:
  /// any finite d.
  void eval(std::size_t n, const double* d, const double* d_hat, double* b, double* db, double* d2b) const;
  void eval(std::size_t n, const float* d, const float* d_hat, float* b, float* db, float* d2b) const;
  ShapeTerms<double> eval(double d, double d_hat) const;
  ShapeTerms<float> eval(float d, float d_hat) const;
};

std::string_view to_string(Argument argument);

}  // namespace bb
