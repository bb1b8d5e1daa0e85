// Whether the numbers of a run may be used: checks of its record, each with value and bound.
#pragma once

#include <string>

#include "core/audit/audit_ledger.hpp"
#include "core/base/record/run_record.hpp"
#include "core/model/scene/scene.hpp"

namespace bb {

/// Fills record.validity from the record's outcome and largest stretch, and from what is not in it:
/// @param ledger    of the audit; null without one, and without its two checks
/// @param hash_time, hash_seen  state hashes of the timed and of the observed pass; empty where there was
/// none
void fill_validity(const Scene& scene, const audit::AuditLedger* ledger, const std::string& hash_time,
                   const std::string& hash_seen, RunRecord& record);

}  // namespace bb
