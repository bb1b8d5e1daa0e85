// One writer a folder: a run and a sweep hold the folder that they write to.
#pragma once

#include <filesystem>

namespace bb {

/// Holds `folder` (made when missing) until destroyed, by flock on `bench.lock` in it; the file says which
/// process on which host, and goes with the lock. A folder that was made and is still empty goes too. The system frees the lock of a process that was killed.
/// Errors: RecordError; one that does not last, naming the holder, when another process has the folder.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  bool try_once();

  std::filesystem::path folder_, path_;
  int fd_ = -1;
  bool made_ = false;  // the folder was not there
};

}  // namespace bb
