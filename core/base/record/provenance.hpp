// Where a number comes from: build, machine, hashes. Reads /proc and the environment; never fails, an unknown
// value is an empty string or 0.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/record/run_record.hpp"
#include "core/math/types.hpp"

namespace bb {

/// What this binary was built from, with argv and the thread settings of the environment.
Provenance collect_provenance(std::vector<std::string> argv, int threads);
Machine collect_machine();

/// All ids of a run. Requires provenance, machine and config of the record to be filled; sets config_id,
/// build_id, machine_id and run_id, keeps the rest. The run_id covers all that made the record: config
/// (meshes by content), executable, libraries with the BLAS kernel that runs, plugins by content, machine,
/// and number of threads (which changes times, no result).
void fill_ids(RunRecord& record);

/// The first bytes of a file that only grows.
struct FilePrefix {
  std::uint64_t bytes = 0;
  std::string sha256;
};

/// SHA-256 of bytes that come one after the other.
class RunningHash {
 public:
  RunningHash();
  ~RunningHash();
  RunningHash(RunningHash&&) noexcept;
  RunningHash& operator=(RunningHash&&) noexcept;
  void add(std::string_view bytes);
  /// Number and hash of all bytes so far. Cost: that of 64 bytes.
  FilePrefix so_far() const;

 private:
  struct Context;
  std::unique_ptr<Context> context_;
  std::uint64_t size_ = 0;
};
/// The hash of the first bytes of a file, to go on with; nothing when the file does not begin with that prefix.
std::optional<RunningHash> hash_of_prefix(const std::string& path, const FilePrefix& prefix);

/// SHA-256 as 64 lower-case hex digits.
std::string sha256_hex(std::string_view bytes);
/// Of a file; empty when it cannot be read.
std::string sha256_file(const std::string& path);
/// Of positions as little-endian float64 in memory order: equal exactly when the states are bit-identical.
std::string state_hash(const Positions& x);
std::string state_hash(std::span<const double> values);

/// config_id of a resolved config: sha256 of its canonical form (keys sorted, no blanks), without `threads`
/// and without the places of files: an object with `file` and `sha256` counts with its hash and its suffix.
/// Errors: std::invalid_argument when it is not JSON.
std::string config_id(std::string_view config_json);
/// The same of the document itself.
std::string config_id_of(nlohmann::json config);

/// Peak resident memory of this process, bytes.
std::uint64_t peak_rss_bytes();
/// Now, as 2024-01-31T12:00:00Z.
std::string utc_now();
/// Seconds since 1970 of such a text, nothing where it is none.
std::optional<double> seconds_of_utc(const std::string& text);

}  // namespace bb
