// What the audit's ledger means for a run, in words that name bodies.
#pragma once

#include <string>

#include "core/audit/audit_ledger.hpp"
#include "core/model/scene/scene.hpp"
#include "experiments/run/outcome.hpp"

namespace bb {

/// "edge cloth[3 4] crosses triangle ball[0 1 2]": the pair by its bodies and their own vertex numbers.
std::string describe(const Scene& scene, const audit::AuditMesh& mesh, const audit::PairName& pair);

/// Where ledger.ok(): ok; the detail reports by how much surfaces are in an obstacle, where the step solver promises no more than that. given_parts_cross: prescribed primitives cross each other, which no solver
/// decides. penetration: a free vertex took part. unproven: neither, but something could not be certified, or
/// nothing was judged.
Verdict judge_audit(const Scene& scene, const audit::AuditMesh& mesh, const audit::AuditLedger& ledger);

}  // namespace bb
