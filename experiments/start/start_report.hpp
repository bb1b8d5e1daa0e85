// What keeps a start from being one, pair by pair: every crossing by exact signs, and every pair that is nearer than its
// d_hat; by pairs of bodies, with names and places.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/audit/surface.hpp"
#include "experiments/config/run_config.hpp"
#include "experiments/run/body_pair.hpp"

namespace bb {

/// One pair of primitives.
struct StartPair {
  BodyPair bodies;
  std::string text;               // "edge cloth[3 4] crosses triangle ball[0 1 2]"
  Vec3d place = Vec3d::Zero();    // m
  double gap = 0;                 // m, thickness taken off; NaN of a crossing
  std::vector<int> vertices;      // of the scene
  bool within_thickness = false;  // a near pair with a gap <= 0
};

struct StartReport {
  std::vector<StartPair> crossings;  // in the order of the audit's names
  std::vector<StartPair> near;       // gap below d_hat, the nearest first
  bool clean() const;                // no crossing, and no gap <= 0
  long within_thickness() const;
};

/// The start x of the scene. mesh: audit_mesh_of(). Cost: one audit and one search for contacts.
StartReport report_start(const RunConfig& config, const Scene& scene, const audit::AuditMesh& mesh,
                         const Positions& x);

/// Where primitives of the mesh that cross meet, m; of an obstacle the primitive's middle.
Vec3d place_of(const audit::AuditMesh& mesh, const audit::PairName& pair, const Positions& x);
/// The vertices of such a pair.
std::vector<int> vertices_of(const audit::AuditMesh& mesh, const audit::PairName& pair);

/// Of each pair of bodies in the list how many pairs of primitives there are.
std::map<BodyPair, long> by_bodies(const std::vector<StartPair>& pairs);

/// The lists as lines of CSV: kind, bodies, pair, x_m, y_m, z_m, gap_m.
std::string start_csv(const Scene& scene, const StartReport& report);
/// The start as a PLY with columns of vertices: body, crossing and near, 1 where a pair of such a list has the vertex.
std::string marked_start(const Scene& scene, const StartReport& report);
/// For a terminal: counts of each pair of bodies and the first pairs of primitives, then how many more there are.
std::string start_text(const Scene& scene, const StartReport& report);

}  // namespace bb
