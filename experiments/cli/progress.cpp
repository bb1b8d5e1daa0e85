#include "experiments/cli/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

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

ProgressLine::ProgressLine(const std::string& mode) {
  if (mode == "plain") mode_ = Mode::plain;
  if (mode == "auto" && isatty(STDERR_FILENO)) mode_ = Mode::rewrite;
}

ProgressLine::~ProgressLine() { clear(); }

void ProgressLine::show(const Progress& progress) {
  if (mode_ == Mode::none) return;
  const double now = now_s();
  const double period = mode_ == Mode::rewrite ? 0.2 : 10.0;
  if (now - last_s_ < period && progress.step < progress.steps) return;
  last_s_ = now;
  const std::string line =
      fmt::format("{} [{}] step {}/{}  newton {}  contacts {}  gap {}  eta {:.0f} s", progress.label,
                  progress.pass, progress.step, progress.steps, progress.newton, progress.contacts,
                  number_text(progress.gap, "{:.2e} m"), progress.eta_s);
  if (mode_ == Mode::rewrite) {
    say("\r\033[K" + line);
    dirty_ = true;
  } else {
    say(line + "\n");
  }
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
