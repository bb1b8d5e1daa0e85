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

}  // namespace bb
