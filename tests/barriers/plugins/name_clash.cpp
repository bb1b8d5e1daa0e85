// Test plugin whose names are taken: shape `log`, policy `fixed`, integrator `bdf2`, and one shape twice. Its
// shape `fresh_shape` is free, and must not be registered either.
#include "core/model/plugin/barrierbench_plugin.h"

namespace {

template <class T>
void zero(void*, size_t n, const T*, const T*, T* b, T* db, T* d2b) {
  for (size_t i = 0; i < n; ++i) b[i] = db[i] = d2b[i] = T(0);
}
void fill(void*, const bb_plugin_rows* rows, double* kappa) {
  for (size_t i = 0; i < rows->n; ++i) kappa[i] = 1;
}
void predict(void*, const bb_plugin_history*, double, double* c, double*) { *c = 1; }
void finish(void*, const bb_plugin_history*, double, double, const double*, const double*, double*, double*) {
}

constexpr bb_plugin_shape shape(const char* name) {
  return {name, "always 0", 9, 0, nullptr, zero<double>, zero<float>};
}
constexpr bb_plugin_shape shapes[] = {shape("log"), shape("fresh_shape"), shape("fresh_shape")};
constexpr bb_plugin_policy policies[] = {{"fixed", "one", 0, nullptr, fill}};
constexpr bb_plugin_integrator integrators[] = {{"bdf2", "still", 0, nullptr, predict, finish}};
constexpr bb_plugin plugin = {BB_PLUGIN_ABI_VERSION, "name_clash", 3, shapes, 1, policies, 1, integrators};

}  // namespace

extern "C" const bb_plugin* barrierbench_plugin(void) { return &plugin; }
