// Runs of a sweep as processes of their own, several at a time.
#pragma once

#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace bb::cli {

/// How a process of a case ended, with its output.
struct JobEnd {
  std::size_t index = 0;
  int code = 0;  // exit code; -N where signal N killed it
  std::string out, err;
};

/// Processes of this program. Each is in a group of its own, so that a key that interrupts the terminal reaches it only through
/// stop(), and gets a signal to stop when this process dies. What they print is kept until they end.
class Jobs {
 public:
  /// words: what stands behind the name of the program. Errors: RecordError that does not last, where the system starts no more.
  void start(std::size_t index, const std::vector<std::string>& words);
  /// Those that have ended since, without waiting for any.
  std::vector<JobEnd> ended();
  /// SIGTERM to all: each keeps its checkpoint. Once.
  void stop();
  std::size_t running() const { return running_.size(); }

 private:
  struct Job {
    std::size_t index;
    int out, err;  // descriptors of files without a name
  };
  std::map<int, Job> running_;  // by process
  bool stopped_ = false;
};

}  // namespace bb::cli
