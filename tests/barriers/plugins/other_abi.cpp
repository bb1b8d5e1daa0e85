// Test plugin built against an interface of the future; nothing behind abi_version may be read.
#include "core/model/plugin/barrierbench_plugin.h"

namespace {
constexpr bb_plugin plugin = {BB_PLUGIN_ABI_VERSION + 1, "other_abi", 1, nullptr, 1, nullptr, 1, nullptr};
}  // namespace

extern "C" const bb_plugin* barrierbench_plugin(void) { return &plugin; }
