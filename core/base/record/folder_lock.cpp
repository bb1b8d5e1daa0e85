#include "core/base/record/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <iterator>

#include "core/base/record/provenance.hpp"

namespace bb {
namespace {

namespace fs = std::filesystem;

std::string this_host() {
  char host[256] = "";
  ::gethostname(host, sizeof host - 1);
  return host;
}

std::string this_process() {
  return "process " + std::to_string(::getpid()) + " on " + this_host() + " since " + utc_now();
}

std::string text_of(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::string holder(const fs::path& path) {
  const std::string text = text_of(path);
  return text.empty() ? "another process" : text;
}

/// Whether the open file is the one that lies there: its holder may have removed it, and another one made a new one.
bool is_still(int fd, const fs::path& path) {
  struct stat ours {
  }, there{};
  return ::fstat(fd, &ours) == 0 && ::stat(path.c_str(), &there) == 0 && ours.st_ino == there.st_ino &&
         ours.st_dev == there.st_dev;
}

/// Whether the lock names another host that has given a sign of life of late.
bool lives_elsewhere(const fs::path& path) {
  const std::string text = text_of(path);
  const std::size_t on = text.find(" on "), since = text.rfind(" since ");
  if (on == std::string::npos || since == std::string::npos || since < on) return false;
  if (text.substr(on + 4, since - on - 4) == this_host()) return false;  // the system has freed its flock
  std::error_code error;
  const auto beat = fs::last_write_time(path, error);
  const std::chrono::duration<double> age = fs::file_time_type::clock::now() - beat;
  return !error && age.count() < dead_after_s;
}

}  // namespace

std::string lock_holder(const fs::path& folder) { return holder(folder / "bench.lock"); }

void remove_dead_lock(const fs::path& folder) {
  const fs::path path = folder / "bench.lock";
  const int fd = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (fd < 0) return;
  if (::flock(fd, LOCK_EX | LOCK_NB) == 0 && is_still(fd, path) && !lives_elsewhere(path))
    ::unlink(path.c_str());
  ::close(fd);
}

FolderLock::FolderLock(const fs::path& folder, double wait_s)
    : folder_(folder), path_(folder / "bench.lock") {
  std::error_code unreachable;
  made_ = !fs::exists(folder, unreachable);
  make_folder(folder);
  take(wait_s);
  const std::string text = this_process();
  if (::ftruncate(fd_, 0) != 0 || ::write(fd_, text.data(), text.size()) != ::ssize_t(text.size())) {
    const int error = errno;  // the destructor does not run
    ::unlink(path_.c_str());
    if (made_) ::rmdir(folder_.c_str());
    ::close(fd_);
    fail_with(path_, "cannot write", error);
  }
  heart_ = std::thread([this] { beat(); });
}

FolderLock::~FolderLock() {
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  wake_.notify_one();
  heart_.join();
  ::unlink(path_.c_str());
  if (made_) ::rmdir(folder_.c_str());  // only when it is empty
  ::close(fd_);
}

void FolderLock::beat() {
  std::unique_lock lock(mutex_);
  const std::chrono::duration<double> period(heartbeat_s);
  while (!wake_.wait_for(lock, period, [this] { return over_; })) ::futimens(fd_, nullptr);
}

void FolderLock::take(double wait_s) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(wait_s);
  while (true) {
    try {
      while (!try_once()) {
      }
      return;
    } catch (const FolderInUse&) {
      if (std::chrono::steady_clock::now() >= end) throw;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
}

/// False when the holder before removed the file between our open and our lock: it no longer locks anybody.
bool FolderLock::try_once() {
  fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd_ < 0 && errno == ENOENT) {  // the holder before removed the folder
    make_folder(folder_);
    fd_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  }
  if (fd_ < 0) fail_with(path_, "cannot open", errno);
  const bool locked = ::flock(fd_, LOCK_EX | LOCK_NB) == 0;
  const int error = errno;
  if (!locked && error != EWOULDBLOCK) {
    ::close(fd_);
    fail_with(path_, "cannot lock", error);
  }
  if (!locked || lives_elsewhere(path_)) {
    ::close(fd_);
    throw FolderInUse(folder_.string() + ": in use by " + holder(path_) + "; try again when it has ended");
  }
  if (is_still(fd_, path_)) return true;
  ::close(fd_);
  return false;
}

}  // namespace bb
