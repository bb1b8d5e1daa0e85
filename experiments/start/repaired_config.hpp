// A repaired start as a config that begins from it: the config with a mesh file for every body whose start is another.
#pragma once

#include <filesystem>
#include <string>

#include "experiments/config/run_config.hpp"

namespace bb {

/// What a repair of this config into this folder needs, asked before the work.
/// Errors: ConfigError for a scene that is not given as bodies, and for a folder that is there.
void require_repairable(const RunConfig& config, const std::filesystem::path& folder);

/// Writes config.json, the meshes that it names and repair.json, the text `numbers`, into a new folder; rest shapes, pins and weights are those of the
/// config, by vertices and not by places. The folder appears only when the config in it has been read, built and found
/// to start at exactly x, with the pins, masses and rest shape of the scene, and without intersections.
/// @param x  [3 x n] m
/// Errors: those of require_repairable; ConfigError for a body that is moved and has a film together with a transform, and
/// where the start is none after all; RecordError.
void write_repaired(const RunConfig& config, const Scene& scene, const Positions& x,
                    const std::string& numbers, const std::filesystem::path& out);

}  // namespace bb
