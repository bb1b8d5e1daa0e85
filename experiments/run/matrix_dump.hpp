// The system of a Newton iteration as it is written to a file.
#pragma once

#include <vector>

#include "core/newton/newton_system.hpp"
#include "experiments/config/run_config.hpp"
#include "experiments/matrix/system_file.hpp"

namespace bb {

/// What the conditioning comes from, as far as the samples of an iteration show: "contact" or "strain_limit"
/// when the (clamped, unscaled) matrix without those terms has a cond less than a tenth of that with them
/// ("contact_or_strain_limit" where only the matrix without both was requested), "elasticity_and_inertia" when
/// neither counts that much. Empty when no stage was requested. A matrix without a cond counts with 1e14.
/// @param stages  those requested; one without a sample has no active terms, and is the stage before it
std::string cause_of(const std::vector<ConditionSample>& samples, const std::vector<std::string>& stages);

/// @param matrix   solved or exact, as `form` says; copied
/// @param samples  of the iteration; those of this very matrix become its known cond
StoredSystem stored_system(Diagnosis& system, const ReducedSystem& matrix, const std::string& form,
                           const RunConfig& config, int step, int iteration,
                           const std::vector<ConditionSample>& samples);

}  // namespace bb
