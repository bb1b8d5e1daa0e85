// Test plugin with a shape without its float call, a policy without a name, and an integrator in capitals.
#include "core/model/plugin/barrierbench_plugin.h"

namespace {

void eval(void*, size_t, const double*, const double*, double*, double*, double*) {}
void fill(void*, const bb_plugin_rows*, double*) {}
void predict(void*, const bb_plugin_history*, double, double*, double*) {}
void finish(void*, const bb_plugin_history*, double, double, const double*, const double*, double*, double*) {
}

constexpr bb_plugin_shape shapes[] = {{"half_a_shape", "", 0, 0, nullptr, eval, nullptr}};
constexpr bb_plugin_policy policies[] = {{nullptr, "", 0, nullptr, fill}};
constexpr bb_plugin_integrator integrators[] = {{"Theta", "", 0, nullptr, predict, finish}};
constexpr bb_plugin plugin = {BB_PLUGIN_ABI_VERSION, "bad_entries", 1, shapes, 1, policies, 1, integrators};

}  // namespace

extern "C" const bb_plugin* barrierbench_plugin(void) { return &plugin; }
