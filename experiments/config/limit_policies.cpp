#include "experiments/config/limit_policies.hpp"

#include "barriers/stiffness/registry.hpp"

namespace bb {

const Registry<LimitPolicyEntry>& limit_policies() {
  static const Registry<LimitPolicyEntry> all({
      {"fixed",
       "kappa_e = k_s x rest area",
       {{"k_s_N_per_m", positive("N/m"), no_default, "stiffness; absent: the matching rule supplies it"}},
       "k_s_N_per_m"},
      {"elasticity_inclusive",
       "kappa_e from the element's Hessian and mass",
       {{"mass_term", word({"paper", "inertia", "scaled"}), "paper",
         "m_e/y^2 times 1 m^2/s^2, M/(c h^2), or M/(c h^2) (width/y)^2"},
        {"elastic_term", flag(), true, "whether the elastic Hessian counts"},
        refresh_parameter(),
        gap_floor_parameter(),
        derivative_parameter()},
       ""},
  });
  return all;
}

}  // namespace bb
