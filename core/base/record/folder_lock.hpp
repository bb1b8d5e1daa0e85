// One writer a folder: a run holds the folder that it writes to, a sweep its own while it writes what belongs to all.
#pragma once

#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

#include "core/base/record/writer.hpp"

namespace bb {

/// Seconds between two signs of life of a lock, and after how many without one its holder counts as dead.
inline constexpr double heartbeat_s = 5, dead_after_s = 60;

/// Another process has the folder. It does not last.
struct FolderInUse : RecordError {
  explicit FolderInUse(const std::string& what) : RecordError(what, false) {}
};

/// Who holds the lock of a folder, or did: "process 7 on HOST since TIME", "another process" where that is not known.
std::string lock_holder(const std::filesystem::path& folder);

/// Removes the lock that a process left when it was killed; that of a living one stays, and one that may not be removed.
void remove_dead_lock(const std::filesystem::path& folder);

/// Holds `folder` (made when missing) until destroyed, by flock on `bench.lock` in it; the file states which
/// process on which host, gets a new time of change every heartbeat_s seconds, and goes with the lock. A folder that was made
/// and is still empty goes too. The system frees the lock of a process that was killed. Where flock does not reach the other
/// machine, as on some network file systems, the lock of another host counts for dead_after_s seconds after its last sign of life.
/// Errors: RecordError; FolderInUse, naming the holder, when another process has the folder after wait_s seconds.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder, double wait_s = 0);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  void take(double wait_s);
  bool try_once();
  void beat();

  std::filesystem::path folder_, path_;
  int fd_ = -1;
  bool made_ = false;  // the folder was not there
  bool over_ = false;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::thread heart_;
};

}  // namespace bb
