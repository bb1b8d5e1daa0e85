// Test plugin: the batch call of the built-in cubic, generated from the same template in another library.
#include "barriers/shapes/builtin_shape.hpp"
#include "barriers/shapes/cubic.hpp"
#include "core/model/plugin/barrierbench_plugin.h"

namespace {
constexpr bb_plugin_shape shapes[] = {{.name = "cubic_copy",
                                       .doc = "the built-in cubic",
                                       .smoothness_at_d_hat = bb::shapes::Cubic::smoothness_at_d_hat,
                                       .infinite_at_zero = bb::shapes::Cubic::infinite_at_zero,
                                       .self = nullptr,
                                       .eval_double = bb::shape_batch<bb::shapes::Cubic, double>,
                                       .eval_float = bb::shape_batch<bb::shapes::Cubic, float>}};
constexpr bb_plugin plugin = {BB_PLUGIN_ABI_VERSION, "cubic_copy", 1, shapes, 0, nullptr, 0, nullptr};
}  // namespace

extern "C" const bb_plugin* barrierbench_plugin(void) { return &plugin; }
