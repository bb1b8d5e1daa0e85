// The files that a run is made of: named from the folder of its record, or copied beside it.
#pragma once

#include <filesystem>
#include <vector>

#include "core/base/record/run_record.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

/// The config with every mesh file, the plugins with every file, relative to `folder`. The folder need not
/// exist yet; links on the way are followed, so that the names hold for the place where the folder really is.
RunConfig name_from(const std::filesystem::path& folder, RunConfig config);
std::vector<PluginFile> name_from(const std::filesystem::path& folder, std::vector<PluginFile> plugins);

/// Copies meshes and plugins to folder/inputs/HASH-NAME, HASH the first 8 digits of their sha256, and makes
/// config and plugins name the copies. A copy that is there already stays. Errors: RecordError; ConfigError
/// when a file is no longer what its hash says.
void copy_inputs(const std::filesystem::path& folder, RunConfig& config, std::vector<PluginFile>& plugins);

}  // namespace bb
