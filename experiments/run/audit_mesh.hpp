// What the audit needs of a scene.
#pragma once

#include "core/audit/surface.hpp"
#include "core/model/scene/scene.hpp"
#include "experiments/config/run_config.hpp"

namespace bb {

/// The whole surface of all bodies, computed from their triangles and rods: never from the pairs that a
/// contact model makes of it, so that the audit judges what the model leaves out. Planar: boundary edges and
/// every vertex. Cost O(n log n).
/// @param dt longest time step, s: prescribed vertices with one motion, and all that stand still, are rigid bodies to the
/// audit where they turn by at most a quarter of a turn a step; the straight paths of a step keep such a body's shape.
audit::AuditMesh make_audit_mesh(const Scene& scene, double dt, bool only_points = false);

/// That of a config: where its contact model acts on points alone, so does what is judged at obstacles.
audit::AuditMesh audit_mesh_of(const RunConfig& config, const Scene& scene);

/// A tenth of the smallest distance (m) at which the solver's step bound stops; see Audit::check_motion.
double audit_tolerance(const Scene& scene, double min_gap_fraction);

}  // namespace bb
