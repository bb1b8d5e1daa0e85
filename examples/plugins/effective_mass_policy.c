/* Example: a stiffness policy, in plain C. The mass that the contact feels along its normal, 1/m_eff = sum
 * w_i^2/m_i, as an inertia stiffness: kappa = m_eff/(c h^2). Without inertia (c = 0) there is none, and kappa
 * is 0. */
#include "core/model/plugin/barrierbench_plugin.h"

static void fill(void* self, const bb_plugin_rows* rows, double* kappa) {
  (void)self;
  for (size_t r = 0; r < rows->n; ++r) {
    double inverse = 0;
    for (size_t i = 4 * r; i < 4 * r + (size_t)rows->n_free[r]; ++i) {
      inverse += rows->weight[i] * rows->weight[i] / rows->mass[i];
    }
    kappa[r] = rows->c > 0 ? 1 / (inverse * rows->c * rows->h * rows->h) : 0;
  }
}

static const bb_plugin_policy policies[] = {{.name = "effective_mass",
                                             .doc = "kappa = m_eff/(c h^2), 1/m_eff = sum w_i^2/m_i",
                                             .needs_hessian = 0,
                                             .self = NULL,
                                             .fill = fill}};

static const bb_plugin plugin = {.abi_version = BB_PLUGIN_ABI_VERSION,
                                 .name = "effective_mass_policy",
                                 .n_policies = 1,
                                 .policies = policies};

const bb_plugin* barrierbench_plugin(void) { return &plugin; }
