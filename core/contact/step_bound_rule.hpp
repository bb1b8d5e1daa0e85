// How contact bounds a motion: one part of it for all vertices, or one for each (docs/theory/newton.md, Bounds of each vertex).
#pragma once

#include <string_view>

namespace bb {

/// accd: additive CCD, the largest part of the motion for all. planar_truncation, planar_balanced,
/// per_vertex: vertex_bounds.hpp.
enum class StepBoundRule { accd, planar_truncation, planar_balanced, per_vertex };

/// Whether every vertex has a part of its own.
constexpr bool bounds_each_vertex(StepBoundRule rule) { return rule != StepBoundRule::accd; }

/// Of the gap, what both sides together may use up in one motion, where each vertex has a bound: relaxed_radius_scaling of
/// the IPC Toolkit, 2 gamma_p of Chen et al. 2025.
inline constexpr double default_bound_gamma = 0.9;

/// In a sentence.
constexpr std::string_view to_string(StepBoundRule rule) {
  switch (rule) {
    case StepBoundRule::accd:
      return "additive CCD";
    case StepBoundRule::planar_truncation:
      return "planar truncation of each vertex";
    case StepBoundRule::planar_balanced:
      return "planar truncation of each vertex, planes where the smallest part is largest";
    case StepBoundRule::per_vertex:
      return "a ball round each vertex";
  }
  return {};
}

}  // namespace bb
