// Mesh files written by us: OBJ for people, binary PLY for frames.
#pragma once

#include <string>

#include "core/mesh/triangle_mesh.hpp"

namespace bb {

/// Vertices with 17 digits (read back bit for bit), faces, segments as `l`.
/// Errors: ConfigError when the file cannot be written whole; nothing half-written stays.
void write_obj(const std::string& path, const TriangleMesh& mesh);

/// Binary little-endian PLY, double coordinates; segments as `edge` elements.
/// Errors: as write_obj.
void write_ply(const std::string& path, const TriangleMesh& mesh);

}  // namespace bb
