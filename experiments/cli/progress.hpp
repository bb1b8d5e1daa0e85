// One line on stderr while a run goes on: rewritten on a terminal, silent elsewhere unless asked for.
#pragma once

#include <atomic>
#include <functional>
#include <string>

#include "experiments/run/runner.hpp"

namespace bb::cli {

/// mode: auto (a terminal only), plain (one line every 10 s), none.
class ProgressLine {
 public:
  explicit ProgressLine(const std::string& mode);
  ~ProgressLine();
  void show(const Progress& progress);
  /// Takes the line away, so that other output starts on a clean one.
  void clear();

 private:
  enum class Mode { none, rewrite, plain };
  Mode mode_ = Mode::none;
  double last_s_ = -1e300;
  bool dirty_ = false;
};

/// Set by SIGINT, SIGTERM and SIGHUP once install_interrupt() was called.
const std::atomic<bool>& interrupted();
void install_interrupt();

/// One table row about a finished run.
std::string summary_row(const RunRecord& record);
std::string summary_header();

}  // namespace bb::cli
