// What a trajectory consists of: topology, obstacles, thickness. One JSON file, which the front end
// (analysis/src/barrierbench_analysis/studies/judge) writes from the files of any program.
#pragma once

#include <optional>
#include <string>

#include "core/audit/pair_text.hpp"
#include "core/audit/surface.hpp"
#include "experiments/judge/elastic_energies.hpp"

namespace bb::judge {

inline constexpr const char* subject_schema = "barrierbench.subject/1";

struct Subject {
  audit::AuditMesh mesh;
  audit::SubjectNames names;
  int n_vertices = 0;
  double reach_m = 0;      // gaps above it are not measured
  double tolerance_m = 0;  // see Audit::check_motion
  std::optional<ElasticPart> elastic;
};

/// The keys (all but the first three may be absent):
///   schema, n_vertices, reach_m
///   bodies [{name, first_vertex}] ascending, the first at 0; absent: one body "surface"
///   triangles [[3]], segments [[2]] of rods: vertex numbers from 0
///   given [] prescribed vertices, which the scene moves; half_thickness_m [n_vertices]; tolerance_m; planar
///   obstacles [{name, kind, point_m, axis, radius_m, inside, vertex}]: kind plane, sphere or cylinder; one with a
///   vertex is where that is in each frame, and the vertex is prescribed and on no surface
///   elastic {config, vertices}: a file with the bodies that have a material, and which vertex each of its vertices is
/// Edges are made of the triangles and segments (planar: of boundary edges); vertices of neither are particles.
/// Errors: ConfigError with file and pointer for every key that is wrong or unknown, and for a subject without any
/// triangle, segment or obstacle: nothing of it could be judged.
Subject read_subject(const std::string& path);

}  // namespace bb::judge
