// Example: a barrier shape. With u = d/d_hat, e = 1 - u:
//   b = (d_hat - d)^3/d = d_hat^2 e^3/u,   b' = -d_hat (3 e^2/u + e^3/u^2),
//   b'' = 6 e/u + 6 e^2/u^2 + 2 e^3/u^3;   C2 at d_hat, infinite at 0
#include "core/model/plugin/barrierbench_plugin.h"

namespace {

template <class T>
void eval(void*, size_t n, const T* d, const T* d_hat, T* b, T* db, T* d2b) {
  for (size_t i = 0; i < n; ++i) {
    b[i] = db[i] = d2b[i] = T(0);
    if (d[i] >= d_hat[i]) continue;
    const T e = (d_hat[i] - d[i]) / d_hat[i];
    const T r = e / (d[i] / d_hat[i]);
    b[i] = d_hat[i] * d_hat[i] * (e * e * r);
    db[i] = -d_hat[i] * (T(3) * e * r + e * r * r);
    d2b[i] = T(6) * r + T(6) * r * r + T(2) * r * r * r;
  }
}

constexpr bb_plugin_shape shapes[] = {{.name = "inverse",
                                       .doc = "inverse barrier, infinite at contact: (d_hat-d)^3/d",
                                       .smoothness_at_d_hat = 2,
                                       .infinite_at_zero = 1,
                                       .self = nullptr,
                                       .eval_double = eval<double>,
                                       .eval_float = eval<float>}};

constexpr bb_plugin plugin = {.abi_version = BB_PLUGIN_ABI_VERSION,
                              .name = "inverse_shape",
                              .n_shapes = 1,
                              .shapes = shapes,
                              .n_policies = 0,
                              .policies = nullptr,
                              .n_integrators = 0,
                              .integrators = nullptr};

}  // namespace

extern "C" const bb_plugin* barrierbench_plugin(void) { return &plugin; }
