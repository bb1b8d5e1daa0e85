// Writes run.json (all or nothing) and trace.jsonl (flushed once a step), and reads run.json again.
#pragma once

#include <cstdio>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

#include "core/base/record/provenance.hpp"
#include "core/base/record/run_record.hpp"

namespace bb {

/// The output cannot be written. what() names the path and the cause.
struct RecordError : std::runtime_error {
  RecordError(const std::string& what, bool will_last) : std::runtime_error(what), lasting(will_last) {}
  bool lasting;  // true: a path that can never be written (read-only, no folder); false: a full disk and the
                 // like
};

/// Throws the RecordError "PATH: WHAT: cause of ERROR", error a value of errno.
[[noreturn]] void fail_with(const std::filesystem::path& path, const char* what, int error);

/// Creates missing folders. Errors: RecordError.
void make_folder(const std::filesystem::path& folder);

/// run.json and one trace line as text; non-finite numbers are null plus "<name>_status".
/// Errors: std::invalid_argument when config is not JSON; std::logic_error for a bare number that
/// is not finite.
std::string to_json(const RunRecord& record);
std::string to_json(const TraceRow& row);

/// The record in `file`; nothing when it cannot be read, is not JSON (torn), or is no record of this project.
/// Errors: ConfigError at the version when its first number is another one, at a field that is missing or of
/// another type. A record of an earlier version may lack fields; unknown fields are left out.
std::optional<RunRecord> read_run(const std::filesystem::path& file);

/// A text that is whole on the disk, beside `path`, until commit() gives it its name; without commit() it
/// goes. So whatever a full disk refuses is known before an earlier file is touched. Errors: RecordError.
class StagedFile {
 public:
  StagedFile(const std::filesystem::path& path, const std::string& text);
  ~StagedFile();
  StagedFile(const StagedFile&) = delete;
  StagedFile& operator=(const StagedFile&) = delete;
  void commit();
  /// The same where no file has that name; false: there is one, which stays. Of several processes one succeeds.
  bool commit_as_first();

 private:
  std::filesystem::path path_, temp_;
};

/// Renames, with the folder of `to` made first. Errors: RecordError naming `to`.
void move_into_place(const std::filesystem::path& from, const std::filesystem::path& to);

/// Replaces `path` by `text` or leaves it as it was: temp file beside it, fsync, rename, fsync of the folder.
/// Creates missing folders. Errors: RecordError; the temp file is removed.
void write_atomically(const std::filesystem::path& path, const std::string& text);

/// write_atomically(folder / "run.json", to_json(record)).
void write_run(const std::filesystem::path& folder, const RunRecord& record);

/// Fails before the run rather than after it: creates the folder, writes and removes a probe file, and sees
/// that no folder has the name of a file that the run ends with (run.json, trace.jsonl), and no file that of
/// a folder (frames, forces, matrices). Errors: RecordError.
void check_writable(const std::filesystem::path& folder);

/// Where the trace of a folder is that begins with `prefix`: trace.jsonl.part, or trace.jsonl once its run was recorded.
std::optional<std::filesystem::path> find_trace(const std::filesystem::path& folder,
                                                const FilePrefix& prefix);

/// folder/trace.jsonl. Written as trace.jsonl.part, so that an earlier trace stays with its run.json until
/// the new run is over; a run that never finishes leaves neither.
class TraceWriter {
 public:
  explicit TraceWriter(const std::filesystem::path& folder);
  /// Goes on behind `prefix` of the trace that find_trace finds; what is behind it goes, from trace.jsonl.part alone.
  /// Errors: RecordError, also when there is none.
  TraceWriter(const std::filesystem::path& folder, const FilePrefix& prefix);
  ~TraceWriter();
  TraceWriter(const TraceWriter&) = delete;
  TraceWriter& operator=(const TraceWriter&) = delete;

  /// Buffers one line. Errors: RecordError.
  void add(const TraceRow& row);
  /// Hands the lines of the step to the system. Errors: RecordError.
  void end_step();
  /// What the record reports of the trace: name, size and sha256 of what was added so far. Cost: that of 64 bytes.
  Artifact artifact() const;
  /// The file is whole on the disk, under the name it has; nothing can be added after it. Errors: RecordError.
  void close();
  /// The same, and it replaces the earlier trace. Errors: RecordError.
  void finish();
  /// What was written so far, handed to the system, with `sync` to the disk. From now on the file stays, also that of a
  /// run that never finishes: a checkpoint names it. Errors: RecordError.
  FilePrefix checkpoint(bool sync);

 private:
  void fail(const char* what) const;
  std::filesystem::path path_, part_;
  std::FILE* file_ = nullptr;
  RunningHash hash_;
  bool leave_ = false;
};

}  // namespace bb
