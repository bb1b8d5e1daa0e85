// The table of friction laws, from registry.inc.
#include "core/energy/friction_law.hpp"

#include "core/energy/friction_list.hpp"

namespace bb {

template <class T>
const Registry<FrictionLaw<T>>& friction_laws_in() {
#define ENTRY(name, doc) \
  FrictionLaw<T>{#name, doc, friction_laws::name::two_coefficients, &friction_laws::name::eval<T>},
  static const Registry<FrictionLaw<T>> laws({
#include "core/energy/friction_laws/registry.inc"
  });
#undef ENTRY
  return laws;
}

std::vector<std::string> friction_law_names() { return friction_laws_in<double>().names(); }

std::vector<std::string> two_coefficient_laws() {
  std::vector<std::string> out;
  for (const FrictionLaw<double>& law : friction_laws_in<double>()) {
    if (law.two_coefficients) out.emplace_back(law.name);
  }
  return out;
}

template const Registry<FrictionLaw<float>>& friction_laws_in<float>();
template const Registry<FrictionLaw<double>>& friction_laws_in<double>();

}  // namespace bb
