#include "experiments/cli/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <csignal>

#include "core/base/input/names.hpp"
#include "core/math/stop_request.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/cli/summary_table.hpp"
#include "experiments/cli/terminal.hpp"
#include "experiments/run/run_limits.hpp"

namespace bb::cli {
namespace {

std::atomic<bool> stop{false};

void on_signal(int signal) {
  stop.store(true);
  std::signal(signal, SIG_DFL);  // a second signal: at once
}

}  // namespace

ProgressLine::ProgressLine(const CommonOptions& common) : begin_s_(now_s()) {
  if (common.progress == "plain") every_s_ = 10;
  if (common.progress_every_s > 0) every_s_ = common.progress_every_s;
  if (common.progress == "none") return;
  mode_ = common.progress == "auto" && isatty(STDERR_FILENO) ? Mode::rewrite : Mode::plain;
  if (mode_ == Mode::plain) teller_ = std::thread([this] { tell_from_time_to_time(); });
}

ProgressLine::~ProgressLine() {
  clear();
  if (!teller_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  wake_.notify_one();
  teller_.join();
}

void ProgressLine::tell_from_time_to_time() {
  std::unique_lock lock(mutex_);
  const std::chrono::duration<double> period(every_s_);
  while (!wake_.wait_for(lock, period, [this] { return over_; })) {
    const std::string where = latest_.empty() ? prefix_ + "before the end of the first step" : latest_;
    say(fmt::format("{}  after {:.0f} s\n", where, now_s() - begin_s_));
  }
}

void ProgressLine::begin(const std::string& prefix) {
  const std::lock_guard lock(mutex_);
  prefix_ = prefix;
  latest_.clear();
}

bool ProgressLine::is_due(bool last) {
  const double now = now_s();
  if (mode_ == Mode::none || (mode_ == Mode::rewrite && now - last_s_ < 0.2 && !last)) return false;
  last_s_ = now;
  return true;
}

void ProgressLine::put(std::string text) {
  const std::lock_guard lock(mutex_);
  latest_ = std::move(text);
  if (mode_ != Mode::rewrite) return;
  const std::size_t columns = terminal_columns(STDERR_FILENO);
  // a full line would move the cursor on
  rewrite_line(shortened_to(printable(latest_), columns > 1 ? columns - 1 : 0));
  dirty_ = true;
}

void ProgressLine::show(const Progress& progress) {
  if (!is_due(progress.step >= progress.steps)) return;
  put(fmt::format("{}{} [{}] step {}/{}  t {:.4g} of {:.4g} s  newton {}  contacts {}  gap {}  eta {:.0f} s",
                  prefix_, progress.label, progress.pass, progress.step, progress.steps, progress.t_s,
                  progress.t_end_s, progress.newton, progress.contacts, number_text(progress.gap, "{:.2e} m"),
                  progress.eta_s));
}

void ProgressLine::tell(const std::string& text) {
  if (is_due(false)) put(text);
}

void ProgressLine::clear() {
  if (!dirty_) return;
  rewrite_line("");
  dirty_ = false;
}

const std::atomic<bool>& interrupted() { return stop; }

void install_interrupt() {
  set_stop_request([] {
    if (interrupted()) throw Interrupted{};
  });
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  std::signal(sweep_died, [](int) { stop.store(true); });
  // under nohup a hang-up is ignored, and stays so
  if (std::signal(SIGHUP, on_signal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

}  // namespace bb::cli
