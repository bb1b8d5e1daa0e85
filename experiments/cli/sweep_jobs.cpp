#include "experiments/cli/sweep_jobs.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>

#include "core/base/record/writer.hpp"
#include "experiments/cli/progress.hpp"

namespace bb::cli {
namespace {

/// All of a file, which is closed.
std::string taken(int file) {
  std::string out;
  char part[4096];
  ::lseek(file, 0, SEEK_SET);
  for (ssize_t n; (n = ::read(file, part, sizeof part)) > 0;) out.append(part, static_cast<std::size_t>(n));
  ::close(file);
  return out;
}

/// Between fork and exec: only what may be called there.
[[noreturn]] void become(std::vector<char*>& words, int out, int err, pid_t parent) {
  ::setpgid(0, 0);
  ::prctl(PR_SET_PDEATHSIG, sweep_died);
  if (::getppid() != parent) ::_exit(75);
  ::dup2(out, STDOUT_FILENO);
  ::dup2(err, STDERR_FILENO);
  ::execv("/proc/self/exe", words.data());
  ::_exit(127);
}

}  // namespace

void Jobs::start(std::size_t index, const std::vector<std::string>& words) {
  std::vector<std::string> kept = words;
  kept.insert(kept.begin(), "bench");
  std::vector<char*> pointers;
  for (std::string& word : kept) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const int out = ::memfd_create("out", MFD_CLOEXEC), err = ::memfd_create("err", MFD_CLOEXEC);
  const pid_t parent = ::getpid();
  const pid_t child = out < 0 || err < 0 ? -1 : ::fork();
  if (child == 0) become(pointers, out, err, parent);
  if (child < 0) {
    const int error = errno;
    ::close(out), ::close(err);
    fail_with("/proc/self/exe", "cannot start another process", error);
  }
  running_[child] = {index, out, err};
}

std::vector<JobEnd> Jobs::ended() {
  std::vector<JobEnd> out;
  for (auto it = running_.begin(); it != running_.end();) {
    int status = 0;
    if (::waitpid(it->first, &status, WNOHANG) != it->first) {
      ++it;
      continue;
    }
    const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    out.push_back({it->second.index, code, taken(it->second.out), taken(it->second.err)});
    it = running_.erase(it);
  }
  return out;
}

void Jobs::stop() {
  if (stopped_) return;
  stopped_ = true;
  for (const auto& [process, job] : running_) ::kill(process, SIGTERM);
}

}  // namespace bb::cli
