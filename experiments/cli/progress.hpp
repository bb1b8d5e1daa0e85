// Where a run is, on stderr: one line that is rewritten on a terminal, elsewhere a line from time to time.
#pragma once

#include <atomic>
#include <condition_variable>
#include <csignal>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "experiments/cli/verbs.hpp"
#include "experiments/run/runner.hpp"

namespace bb::cli {

/// mode: auto (a terminal: rewritten; else a line every 30 s), plain (a line every 10 s), none.
class ProgressLine {
 public:
  explicit ProgressLine(const CommonOptions& common);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  /// In front of every line from now on: which case of a sweep it is.
  void begin(const std::string& prefix);
  void show(const Progress& progress);
  /// Any other text as the line.
  void tell(const std::string& text);
  /// Takes the line away, so that other output starts on a clean one.
  void clear();

 private:
  enum class Mode { none, rewrite, plain };
  void tell_from_time_to_time();
  bool is_due(bool last);
  void put(std::string text);

  Mode mode_ = Mode::none;
  double every_s_ = 30, last_s_ = -1e300, begin_s_ = 0;
  bool dirty_ = false;
  std::string prefix_, latest_;  // below: of the two threads
  bool over_ = false;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::thread teller_;  // a step may take longer than the time between two lines
};

/// What the system sends a run whose sweep has died: once for every thread that the sweep had, so that, unlike the others, it
/// has no further effect when it comes again.
constexpr int sweep_died = SIGUSR1;

/// Set by SIGINT, SIGTERM, SIGHUP and sweep_died once install_interrupt() was called.
const std::atomic<bool>& interrupted();
void install_interrupt();

}  // namespace bb::cli
