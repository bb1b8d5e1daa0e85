// Where on two primitives the closest points lie, by name: the words of queries and records.
#pragma once

#include "core/math/host_device.hpp"

namespace bb {

/// First the feature of the first primitive, then that of the second; e and t alone mean the interior.
enum class Region : unsigned char {
  // point-point, point-edge
  p_p,
  p_e0,
  p_e1,
  p_e,
  // point-triangle
  p_t0,
  p_t1,
  p_t2,
  p_e01,
  p_e12,
  p_e20,
  p_t,
  // edge-edge
  ea0_eb0,
  ea0_eb1,
  ea1_eb0,
  ea1_eb1,
  ea_eb0,
  ea_eb1,
  ea0_eb,
  ea1_eb,
  ea_eb
};
constexpr int n_regions = 20;

constexpr const char* region_name(Region region) {
  constexpr const char* names[n_regions] = {
      "p_p", "p_e0",    "p_e1",    "p_e",     "p_t0",    "p_t1",   "p_t2",   "p_e01",  "p_e12",  "p_e20",
      "p_t", "ea0_eb0", "ea0_eb1", "ea1_eb0", "ea1_eb1", "ea_eb0", "ea_eb1", "ea0_eb", "ea1_eb", "ea_eb"};
  return names[static_cast<int>(region)];
}

/// What moves freely in a region: weight slides along up to two edges (from point `from` to point `to`).
struct FreeEdges {
  int count;
  int from[2], to[2];
};

BB_HD constexpr FreeEdges free_edges(Region region) {
  switch (region) {
    case Region::p_e:
    case Region::p_e01:
      return {1, {1, 0}, {2, 0}};
    case Region::p_e12:
      return {1, {2, 0}, {3, 0}};
    case Region::p_e20:
      return {1, {3, 0}, {1, 0}};
    case Region::p_t:
      return {2, {1, 1}, {2, 3}};
    case Region::ea_eb0:
    case Region::ea_eb1:
      return {1, {0, 0}, {1, 0}};
    case Region::ea0_eb:
    case Region::ea1_eb:
      return {1, {2, 0}, {3, 0}};
    case Region::ea_eb:
      return {2, {0, 2}, {1, 3}};
    default:
      return {0, {0, 0}, {0, 0}};
  }
}

}  // namespace bb
