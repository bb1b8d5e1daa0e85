// In which arithmetic the pipeline runs (docs/reference/arithmetic.md, Precision): the scalar with which the templates of geometry,
// elements and shapes are called. Storage stays double, which holds every float.
#pragma once

#include <limits>
#include <utility>

#include "core/math/types.hpp"

namespace bb {

/// full: all in double. mixed: the Hessians of elements and contacts in float, all else in double. single: state,
/// gaps, energies, gradients, Hessians and step bounds in float.
enum class Precision { full, mixed, single };

/// Whether states, gaps, energies and gradients are float.
constexpr bool values_in_float(Precision precision) { return precision == Precision::single; }

/// Relative rounding of states, gaps and energies.
constexpr double value_epsilon(Precision precision) {
  return values_in_float(precision) ? std::numeric_limits<float>::epsilon()
                                    : std::numeric_limits<double>::epsilon();
}

/// f.operator()<T>() with the scalar T of states, gaps, energies and gradients. To be called round a loop, not in it,
/// unless an entry of the loop costs far more than the choice.
template <class F>
decltype(auto) with_value_scalar(Precision precision, const F& f) {
  return values_in_float(precision) ? f.template operator()<float>() : f.template operator()<double>();
}

/// What one pass over elements or rows has to write.
struct PassParts {
  bool values, hessians;  // energies and gradients; Hessians
};

/// f.operator()<T>(parts) for each pass that the precision needs: one, or two where values and Hessians differ.
template <class F>
void for_each_pass(Precision precision, const F& f) {
  switch (precision) {
    case Precision::full:
      return f.template operator()<double>(PassParts{true, true});
    case Precision::mixed:
      f.template operator()<double>(PassParts{true, false});
      return f.template operator()<float>(PassParts{false, true});
    case Precision::single:
      return f.template operator()<float>(PassParts{true, true});
  }
}

/// Every coordinate to the nearest number that a state of this precision may have.
inline void round_state(Precision precision, PositionsSpan x) {
  if (values_in_float(precision)) x = x.cast<float>().cast<double>().eval();
}

}  // namespace bb
