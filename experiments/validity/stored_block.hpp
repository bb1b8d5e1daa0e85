// The block of this build on disk: computed by the first run, read by the others.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/base/record/run_record.hpp"
#include "experiments/validity/block.hpp"

namespace bb {

/// What a block belongs to: executable, libraries with the BLAS kernel that runs, plugins, machine.
struct BuildKey {
  std::string text, sha256;
};
BuildKey this_build(const std::vector<PluginFile>& plugins);

/// The report as JSON: schema barrierbench.validity/1, what it is of, every check.
std::string report_text(const BuildKey& build, const std::vector<BlockCheck>& checks);

/// What a record keeps of a report.
BuildValidity summary_of(const std::vector<BlockCheck>& checks, const std::string& report);

/// Of this build: read from `folder`/<key>.json, else computed and written there; an unreadable or foreign file is
/// replaced. Of several processes that compute it at once all have the report of the first. Where `folder` cannot be
/// written the block is computed all the same, and `kept` is false.
/// Errors: none.   Cost: milliseconds, the first time of a build that of `compute`, which tests replace.
struct StoredBlock {
  BuildValidity validity;
  std::string report;  // JSON
  std::filesystem::path file;
  bool kept = false;
};
StoredBlock block_of_this_build(const std::filesystem::path& folder, const std::vector<PluginFile>& plugins,
                                const std::function<std::vector<BlockCheck>()>& compute = compute_block);

/// Beside the program: validity/ in its folder.
std::filesystem::path validity_folder();

}  // namespace bb
