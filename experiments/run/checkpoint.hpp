// The checkpoint of a run that is not over: files in its folder from which `bench run --resume` goes on
// (docs/reference/outcomes.md).
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/archive/archive.hpp"
#include "core/base/record/provenance.hpp"

namespace bb {

/// In the folder of the run:
///   checkpoint.bin       a checkpoint that is whole on the disk, replaced at most once a second;
///   checkpoint.next.bin  the latest one, written over in place: one that was cut off is not read;
///   checkpoint.log       lists that grow with the steps (GrownLists), each item once.
/// The first two begin with lines of text: the format, the program that wrote it, length and SHA-256 of all that follows:
/// the config of the run, its number, length and SHA-256 of the log and of the trace that belong to it, and an archive, which only that program
/// can read. A log or trace that is longer is cut. So a process that is killed loses nothing, and a power
/// failure what came after the last whole second.
class Checkpoint {
 public:
  /// config: JSON of the run's resolved config.
  Checkpoint(const std::filesystem::path& folder, std::string program, const std::string& config = "{}");
  ~Checkpoint();
  Checkpoint(const Checkpoint&) = delete;
  Checkpoint& operator=(const Checkpoint&) = delete;

  /// The archive of the latest checkpoint; nothing when there is none. What is written after it goes on from there.
  /// Errors: ConfigError naming the file when checkpoint.bin, the log or the trace is not what was written, is cut off or
  ///   damaged, or was written by another program.
  std::optional<Archive> read();
  /// What was read is of no use: the next one is the first of a run.
  void forget();
  /// Of the checkpoint that was read: the trace that belongs to it.
  const FilePrefix& trace() const { return trace_; }

  /// An archive to be written, with its lists in the log.
  Archive begin() { return Archive(lists_); }
  /// Whether the next one should be safe from a power failure too: the first, and one a second after.
  bool should_sync() const;
  /// trace: what was written of it, {} without one. sync: the caller has brought the trace to the disk, and this does so
  /// with the rest. Errors: RecordError.
  void write(const Archive& archive, const FilePrefix& trace, bool sync);
  /// The run is over.
  void remove();
  bool exists() const;
  /// The config of the checkpoint that is there, whatever program wrote it; nothing where the file does not say it.
  std::optional<std::string> config_there() const;

  const std::filesystem::path& file() const { return file_; }

 private:
  struct Read;
  std::optional<Read> read_one(const std::filesystem::path& file, bool may_be_torn) const;
  void append_to_log(bool sync);
  void write_in_place(const std::string& text);

  std::filesystem::path folder_, file_, next_, log_;
  std::string program_, config_;
  GrownLists lists_;
  RunningHash log_hash_;
  FilePrefix trace_;
  std::uint64_t number_ = 0;
  double synced_s_ = -1;  // on the clock, of the last one on the disk
  int log_fd_ = -1, next_fd_ = -1;
};

}  // namespace bb
