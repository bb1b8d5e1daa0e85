// A record on the disk as the program needs it again: to repeat the run, and to see whether a run that is
// requested was made by the same program from the same things.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/base/record/run_record.hpp"
#include "core/math/error.hpp"

namespace bb {

struct StoredRun {
  std::filesystem::path file;
  RunRecord record;  // config_id computed anew; names of files are relative to the record's folder
};

/// read_run, with its errors.
std::optional<StoredRun> read_stored_run(const std::filesystem::path& file);

/// What is wrong with the trace beside the record: it is another one than the record names, and then the two are not of one
/// run. Nothing where there is none, or where the record, of before 3.4, names none. Cost: reading the trace.
std::optional<ConfigError> trace_fault(const StoredRun& stored);

/// One thing that made the stored run and is another one now.
struct Difference {
  std::string what;            // "another build (commit 1a2b3c4d, not 5e6f7a8b)"
  bool changes_state = false;  // the final state may depend on it; false: only times do
};
/// In the order config, program, plugins, libraries with the BLAS kernel, processor, threads. Empty exactly
/// when the ids agree.
std::vector<Difference> differences(const RunRecord& then, const RunRecord& now);

/// Whether time or memory, of the process or of its device, ended the run before its last step: another call may have
/// more of it.
bool was_cut(Outcome outcome);

/// Why the record `then` does not stand for the run `now`: what differs, or that memory or time ended it, which another call
/// may have more of. Empty: it does.
std::string why_run_again(const RunRecord& then, const RunRecord& now);
/// The same of a record on the disk, whose files have to be there too: its own trace, frames, matrices. Cost: reading the trace.
std::string why_run_again(const StoredRun& then, const RunRecord& now);

}  // namespace bb
