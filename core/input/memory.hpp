// The memory of this process, and the refusal of a scene that cannot fit into it.
#pragma once

#include <cstdint>
#include <string>

namespace bb {

/// Bytes that this process may use: the smallest of physical memory, the limit of its control group and its
/// limit on address space (ulimit -v). Reads files of /proc and /sys; never fails.
std::uint64_t memory_bytes();

/// Elements of a surface that is about to be built.
struct SurfaceSize {
  double vertices = 0, triangles = 0, segments = 0;  // double: a product of counts may be beyond any integer
};

/// Bytes that a scene of that size needs before its first step, from below: mesh, elements, contact surface,
/// matrix pattern. Measured: `check` of a grid of 250000 vertices and 498002 triangles takes 514 MB.
double scene_bytes(const SurfaceSize& size);

/// Errors: ConfigError at `where` with the estimate when a scene of that size needs more than memory_bytes().
void require_memory(const std::string& where, const SurfaceSize& size);

}  // namespace bb
