// Files of a config that are known by their hash from when it was read. Private to experiments/config.
#pragma once

#include <string>

#include "core/base/input/read_file.hpp"
#include "core/model/scene/film_source.hpp"
#include "experiments/config/reader.hpp"

namespace bb {

/// SHA-256 (hex) of a file; empty after a violation at `pointer`.
std::string hash_of(const std::string& path, const InputKind& kind, const std::string& pointer,
                    const Reader& reader);
/// Of the object that names it, whose `sha256`, where there is one, has to be that of the file.
void read_hashed(const nlohmann::json& object, const InputKind& kind, const std::string& pointer,
                 const Reader& reader, HashedFile& file);
/// Its bytes.   Errors: ConfigError where it cannot be read, or has changed.
std::string unchanged(const HashedFile& file, const InputKind& kind);

}  // namespace bb
