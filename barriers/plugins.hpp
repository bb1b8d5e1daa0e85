// Makes what a plugin holds known to every registry.
#pragma once

#include <string>

#include "core/model/plugin/plugin.hpp"

namespace bb {

/// Loads the file and registers its shapes, stiffness policies and integrators; all of them or none. Before
/// the first run only. Returns what was loaded, for the record. Errors: ConfigError at the file: what
/// load_plugin refuses, or names that are taken (all at once).
Plugin register_plugin(const std::string& file);

}  // namespace bb
