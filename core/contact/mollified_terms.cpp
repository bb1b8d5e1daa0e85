// Mollified rows in float and in double, for all that include the header.
#include "core/contact/mollified_terms.hpp"

namespace bb {

#define BB_MOLLIFIED_TERMS(T)                                                                               \
  template MollifiedDerivatives<T> mollified_derivatives<T>(const Mat<T, 3, 4>&, T, T, T, T);               \
  template MollifiedDerivatives<T> mollified_derivatives<T>(const Mat<T, 3, 3>&, const Vec<T, 3>&, T, T, T, \
                                                            T);                                             \
  template void project_leading<T>(int, Projection, Mat<T, 12, 12>&)
BB_MOLLIFIED_TERMS(float);
BB_MOLLIFIED_TERMS(double);
#undef BB_MOLLIFIED_TERMS

}  // namespace bb
