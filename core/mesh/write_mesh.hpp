// Meshes written by us: OBJ for people, binary PLY for frames.
#pragma once

#include <string>

#include "core/mesh/triangle_mesh.hpp"

namespace bb {

/// Vertices with 17 digits (read back bit for bit), faces, segments as `l`.
/// Errors: ConfigError when the file cannot be written whole; nothing half-written stays.
void write_obj(const std::string& path, const TriangleMesh& mesh);

/// The bytes of a binary little-endian PLY file, double coordinates; segments as `edge` elements.
std::string ply_bytes(const TriangleMesh& mesh);

}  // namespace bb
