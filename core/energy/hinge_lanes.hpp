// Four hinges side by side: the projection's chain of square roots and divisions bounds a hinge.
#pragma once

#include "core/energy/hinge.hpp"

namespace bb {

constexpr int hinge_lanes = 4;

/// What hinge_terms_of() needs of each of them. Host only.
template <class T>
struct HingesAbreast {
  T x[12][hinge_lanes];  // m, point-major
  HingeEnergy<T> energy[hinge_lanes];

  void set(int lane, const Vec<T, 3> (&points)[4], const HingeEnergy<T>& of) {
    for (int i = 0; i < 4; ++i) {
      for (int c = 0; c < 3; ++c) x[3 * i + c][lane] = points[i][c];
    }
    energy[lane] = of;
  }
};

/// The terms of each, with the bits of hinge_terms_of(). Of float and double.
template <class T>
void hinge_terms_abreast(const HingesAbreast<T>& hinges, Projection projection,
                         TermsAbreast<T, hinge_lanes, 4>& out);

}  // namespace bb
