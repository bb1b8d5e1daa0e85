// The element functions that headers declare as compiled elsewhere, in float and in double.
#include "core/energy/cloth_spring.hpp"
#include "core/energy/hinge.hpp"
#include "core/energy/rod_bend.hpp"
#include "core/energy/spring.hpp"

namespace bb {

#define BB_ELEMENT_TERMS(T)                                                                                 \
  template ElementTerms<T, 12> hinge_terms_of<T>(const Vec<T, 3>(&)[4], const HingeEnergy<T>&, Projection); \
  template ElementTerms<T, 9> rod_bend_terms<T>(const Vec<T, 3>(&)[3], T, T, Projection);                   \
  template ElementTerms<T, 6> spring_terms<T>(const Vec<T, 3>(&)[2], T, T, Projection);                     \
  template ElementTerms<T, 6> cloth_spring_terms<T>(const Vec<T, 3>(&)[2], T, const SpringLaw<T>&, Projection)
BB_ELEMENT_TERMS(float);
BB_ELEMENT_TERMS(double);
#undef BB_ELEMENT_TERMS

}  // namespace bb
