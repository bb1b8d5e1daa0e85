// What a run finds in its folder: whose record is there, and whether it may be replaced. Decided here for runs of the program, of
// the Python module and of sweeps.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "core/base/record/run_record.hpp"

namespace bb {

/// What a run may replace in its folder.
enum class Replace {
  own,   // record and checkpoint of the same config
  torn,  // and a record that was cut off, a checkpoint that cannot be read: of the folder of a case of a sweep
  all    // every file of the name of a record or checkpoint, of whatever config
};

/// A run, and the folder that it is to go to.
struct AskedRun {
  std::filesystem::path folder;
  const RunRecord& now;  // as identified() names it from this folder
  Replace replace = Replace::own;
  bool resumes = false;  // it is refused without a checkpoint of this very run
  std::string also;      // the resolved config that the caller gave, where the run changes it; may be empty
};

/// A run may replace record and checkpoint in its folder when they are of the same config, as this program resolves it; `tell`,
/// which may be empty, receives what else made the record: another build, plugin, library or machine.
/// Errors: ConfigError naming run.json or checkpoint.bin, and the first setting that differs: that of another config, or a file
///   that is no record or checkpoint of this version. Nothing is written.
void require_replaceable(const AskedRun& asked, const std::function<void(const std::string&)>& tell);

}  // namespace bb
