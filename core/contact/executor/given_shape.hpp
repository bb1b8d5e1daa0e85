// A barrier shape on rows that came after the program was built: of a plugin, of a formula, of a Python class, an exponent.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/barrier/shape.hpp"
#include "core/barrier/squared_gap.hpp"
#include "core/contact/executor/executor_rows.hpp"

namespace bb::exec {

/// EvaluateShape of a shape that is known as a batch call, which runs in the memory of the host, so kernels.inc has no line of
/// it. Device code of the shape (Shape::device_code) takes the same struct and reads rows and argument.
struct EvaluateGivenShape {
  RowView rows;
  Argument argument;
  ShapeBatch<double> call;
  void* self;
  bool infinite_at_zero;
  void operator()(Index r) const {
    const double d = rows.d[r], d_hat = rows.d_hat[r];
    ShapeTerms<double> terms{};
    if (argument == Argument::gap) {
      call(self, 1, &d, &d_hat, &terms.b, &terms.db, &terms.d2b);
    } else {
      const double d_sq = d * d, d_hat_sq = d_hat * d_hat;
      call(self, 1, &d_sq, &d_hat_sq, &terms.b, &terms.db, &terms.d2b);
      chain_squared_gap(infinite_at_zero, d, d_sq, d_hat_sq, terms.b, terms.db, terms.d2b);
    }
    const double kappa = rows.kappa ? rows.kappa[r] : rows.uniform_kappa;
    rows.energy[r] = kappa * terms.b;
    rows.force[r] = kappa * terms.db;
    rows.stiffness[r] = kappa * terms.d2b;
  }
};

/// Where the members lie that a kernel of such a shape reads and writes, a byte each: PTX that is made at run time holds this
/// against that of the program, which may have been built from other sources.
constexpr std::uint64_t given_shape_layout = [] {
  const std::size_t places[] = {offsetof(EvaluateGivenShape, argument),
                                offsetof(RowView, d),
                                offsetof(RowView, d_hat),
                                offsetof(RowView, kappa),
                                offsetof(RowView, uniform_kappa),
                                offsetof(RowView, energy),
                                offsetof(RowView, force),
                                offsetof(RowView, stiffness)};
  std::uint64_t packed = 0;
  for (const std::size_t place : places) packed = packed << 8 | place;
  return packed;
}();
static_assert(sizeof(EvaluateGivenShape) < 256);

}  // namespace bb::exec
