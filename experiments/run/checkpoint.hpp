// The checkpoint of a run that is not over: a file in its folder from which `bench run --resume` goes on
// (docs/design.md, Outcomes, retries, resume).
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/archive/archive.hpp"
#include "core/record/run_record.hpp"

namespace bb {

/// FOLDER/checkpoint.bin: a first line that names the format, a line with the program that wrote it, a line with
/// size and SHA-256 of the rest, an empty line, and an archive, which only that program can read.
class Checkpoint {
 public:
  Checkpoint(const std::filesystem::path& folder, std::string program);

  /// The archive in the file; nothing when there is none.
  /// Errors: ConfigError naming the file when it is no checkpoint, is cut off or damaged, or was written by
  ///   another program.
  std::optional<Archive> read() const;
  /// Replaces the file, whole or not at all. Errors: RecordError.
  void write(const Archive& archive) const;
  /// The run is over.
  void remove() const;

  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  std::string program_;
};

}  // namespace bb
