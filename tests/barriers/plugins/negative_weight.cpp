// Test plugin with an integrator that only fails once a run has begun: its inertia weight c is negative.
#include "core/model/plugin/barrierbench_plugin.h"

namespace {

void predict(void*, const bb_plugin_history*, double, double* c, double*) { *c = -1; }
void finish(void*, const bb_plugin_history*, double, double, const double*, const double*, double*, double*) {
}

constexpr bb_plugin_integrator integrators[] = {{"negative_weight", "", 0, nullptr, predict, finish}};
constexpr bb_plugin plugin = {
    BB_PLUGIN_ABI_VERSION, "negative_weight", 0, nullptr, 0, nullptr, 1, integrators};

}  // namespace

extern "C" const bb_plugin* barrierbench_plugin(void) { return &plugin; }
