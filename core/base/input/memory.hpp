// The memory of this process, and the refusal of a scene that cannot fit into it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace bb {

/// Bytes that this process may use: the smallest of physical memory, the limit of its control group and its
/// limit on address space (ulimit -v). Reads files of /proc and /sys; never fails.
std::uint64_t memory_bytes();

/// Primitives of one kind that are about to be built, and what each of them takes before the first step, from below: mesh, elements,
/// contact surface, matrix pattern. Measured: `check` of a grid of 250000 vertices and 498002 triangles takes 514 MB.
struct MemoryItem {
  const char* name;
  double count;  // double: a product of counts may be beyond any integer
  double bytes_each;
};
inline MemoryItem vertex_memory(double count) { return {"vertices", count, 400}; }
inline MemoryItem triangle_memory(double count) { return {"triangles", count, 800}; }
inline MemoryItem segment_memory(double count) { return {"segments", count, 400}; }
inline MemoryItem tetrahedron_memory(double count) { return {"tetrahedra", count, 1200}; }
/// The three of a surface of triangles.
inline std::vector<MemoryItem> surface_memory(double vertices, double triangles) {
  return {vertex_memory(vertices), triangle_memory(triangles), segment_memory(0)};
}

double scene_bytes(const std::vector<MemoryItem>& items);

/// Errors: ConfigError at `where` with the estimate when a scene of these primitives needs more than memory_bytes().
void require_memory(const std::string& where, const std::vector<MemoryItem>& items);

}  // namespace bb
