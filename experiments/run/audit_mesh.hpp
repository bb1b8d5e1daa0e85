// What the audit needs of a scene.
#pragma once

#include "core/audit/surface.hpp"
#include "core/scene/scene.hpp"

namespace bb {

audit::AuditMesh make_audit_mesh(const Scene& scene);

}  // namespace bb
