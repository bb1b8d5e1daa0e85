#include "experiments/cli/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <csignal>

#include "experiments/cli/say.hpp"

namespace bb::cli {
namespace {

std::atomic<bool> stop{false};

void on_signal(int signal) {
  stop.store(true);
  std::signal(signal, SIG_DFL);  // asked twice: at once
}

std::string number_text(const Number& number, const char* format) {
  return number.finite() ? fmt::format(fmt::runtime(format), number.value) : "-";
}

std::string cond_text(const RunRecord& record, const std::string& key) {
  const auto found = record.summary.cond.find(key);
  if (found == record.summary.cond.end() || !found->second.log10_cond.max.finite()) return "-";
  const double largest = found->second.log10_cond.max.value;
  if (largest >= 14) return ">1e14";  // the largest that is claimed, and what a singular matrix counts with
  return fmt::format("{}1e{:.2f}", found->second.statuses.contains("lower_bound") ? ">" : "", largest);
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
  say("\r\033[K" + latest_);
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
  say("\r\033[K");
  dirty_ = false;
}

const std::atomic<bool>& interrupted() { return stop; }

void install_interrupt() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  std::signal(sweep_died, [](int) { stop.store(true); });
  // under nohup a hang-up is ignored, and stays so
  if (std::signal(SIGHUP, on_signal) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

std::string summary_header() {
  return fmt::format("{:<44} {:<18} {:>6} {:>7} {:>9} {:>9} {:>9} {:>9} {:>9} {:>8}", "run", "outcome",
                     "steps", "newton", "cond max", "cond bj", "gap/d_hat", "stretch", "crossings", "time s");
}

std::string summary_row(const RunRecord& record) {
  const Summary& s = record.summary;
  const std::string name =
      record.labels.note.empty() ? record.labels.scene + " " + record.labels.formulation : record.labels.note;
  return fmt::format(
      "{:<44} {:<18} {:>6} {:>7} {:>9} {:>9} {:>9} {:>9} {:>9} {:>8}", name, to_string(record.status.outcome),
      s.steps, s.newton_iterations, cond_text(record, "full/none"), cond_text(record, "full/block_jacobi"),
      number_text(s.gap_min_rel.min, "{:.3g}"), number_text(s.max_stretch, "{:.4f}"),
      record.audit.enabled ? fmt::format("{}", record.audit.crossings + record.audit.violations) : "-",
      number_text(s.wall_s, "{:.2f}"));
}

}  // namespace bb::cli
