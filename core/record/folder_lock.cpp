#include "core/record/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

#include "core/record/provenance.hpp"
#include "core/record/writer.hpp"

namespace bb {
namespace {

namespace fs = std::filesystem;

std::string this_process() {
  char host[256] = "";
  ::gethostname(host, sizeof host - 1);
  return "process " + std::to_string(::getpid()) + " on " + host + " since " + utc_now();
}

std::string holder(const fs::path& path) {
  std::ifstream in(path);
  const std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  return text.empty() ? "another process" : text;
}

}  // namespace

FolderLock::FolderLock(const fs::path& folder) : folder_(folder), path_(folder / "bench.lock") {
  std::error_code unreachable;
  made_ = !fs::exists(folder, unreachable);
  make_folder(folder);
  while (!try_once()) {
  }
  const std::string text = this_process();
  if (::ftruncate(fd_, 0) == 0 && ::write(fd_, text.data(), text.size()) == ::ssize_t(text.size())) return;
  const int error = errno;  // the destructor does not run
  ::unlink(path_.c_str());
  if (made_) ::rmdir(folder_.c_str());
  ::close(fd_);
  fail_with(path_, "cannot write", error);
}

FolderLock::~FolderLock() {
  ::unlink(path_.c_str());
  if (made_) ::rmdir(folder_.c_str());  // only when it is empty
  ::close(fd_);
}

/// False when the holder before removed the file between our open and our lock: it no longer locks anybody.
bool FolderLock::try_once() {
  fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd_ < 0 && errno == ENOENT) {  // the holder before removed the folder
    make_folder(folder_);
    fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  }
  if (fd_ < 0) fail_with(path_, "cannot open", errno);
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    const int error = errno;
    ::close(fd_);
    if (error != EWOULDBLOCK) fail_with(path_, "cannot lock", error);
    throw RecordError(folder_.string() + ": in use by " + holder(path_) + "; try again when it has ended",
                      false);
  }
  struct stat ours {
  }, there{};
  if (::fstat(fd_, &ours) == 0 && ::stat(path_.c_str(), &there) == 0 && ours.st_ino == there.st_ino &&
      ours.st_dev == there.st_dev) {
    return true;
  }
  ::close(fd_);
  return false;
}

}  // namespace bb
