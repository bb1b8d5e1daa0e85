// What a run finds in its folder: whose record is there, and whether it may be replaced. Decided here for runs of the program, of
// the Python module and of sweeps.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "core/record/run_record.hpp"

namespace bb {

/// A run may replace the record in its folder when that is of the same config (config_id); `tell`, which may be empty, is told what
/// else made it: another build, plugin, library or machine. With `replace` it may replace whatever has that name.
/// @param now  the run that is asked for, as identified() names it from this folder
/// Errors: ConfigError naming run.json: the record of another config, or a file that is no record of this version. Nothing is
///   written.
void require_replaceable(const std::filesystem::path& folder, const RunRecord& now, bool replace,
                         const std::function<void(const std::string&)>& tell);

}  // namespace bb
