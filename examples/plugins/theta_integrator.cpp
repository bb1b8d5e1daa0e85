// Example: an integrator. The theta method, between backward Euler (theta = 1) and the
// trapezoidal rule (1/2):
//   x = x_n + h ((1 - theta) v_n + theta v),   v = v_n + h ((1 - theta) a_n + theta a)
// Putting v into x gives c = theta^2 and x_tilde = x_n + h v_n + h^2 theta (1 - theta) a_n.
#include "core/model/plugin/barrierbench_plugin.h"

namespace {

constexpr double theta = 0.55;  // a little numerical damping: above 1/2, below 1

void predict(void*, const bb_plugin_history* history, double h, double* c, double* x_tilde) {
  *c = theta * theta;
  for (size_t i = 0; i < 3 * history->n; ++i) {
    x_tilde[i] = history->x[i] + h * history->v[i] + h * h * theta * (1 - theta) * history->a[i];
  }
}

void finish(void*, const bb_plugin_history* history, double h, double c, const double* x_tilde,
            const double* x, double* v, double* a) {
  for (size_t i = 0; i < 3 * history->n; ++i) {
    a[i] = (x[i] - x_tilde[i]) / (c * h * h);
    v[i] = history->v[i] + h * ((1 - theta) * history->a[i] + theta * a[i]);
  }
}

constexpr bb_plugin_integrator integrators[] = {{.name = "theta",
                                                 .doc = "theta method with theta = 0.55",
                                                 .needs_acceleration = 1,
                                                 .self = nullptr,
                                                 .predict = predict,
                                                 .finish = finish}};

constexpr bb_plugin plugin = {.abi_version = BB_PLUGIN_ABI_VERSION,
                              .name = "theta_integrator",
                              .n_shapes = 0,
                              .shapes = nullptr,
                              .n_policies = 0,
                              .policies = nullptr,
                              .n_integrators = 1,
                              .integrators = integrators};

}  // namespace

extern "C" const bb_plugin* barrierbench_plugin(void) { return &plugin; }
