#include "experiments/cli/sweep_run.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <set>
#include <thread>

#include "core/base/record/folder_lock.hpp"
#include "core/base/record/provenance.hpp"
#include "experiments/cli/progress.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/cli/summary_table.hpp"
#include "experiments/cli/sweep_jobs.hpp"
#include "experiments/cli/terminal.hpp"

namespace bb::cli {
namespace {

/// The cases of one call, their order, and how far it is.
class SweepRun {
 public:
  explicit SweepRun(const Sweep& sweep) : sweep_(sweep), line_(sweep.common), begin_s_(now_s()) {
    tally_.refused.resize(sweep.spec.cases.size());
  }

  SweepTally here() {
    for (const std::size_t i : sweep_.chosen) {
      line_.begin(fmt::format("[{}/{}] {}", ++looked_at_, sweep_.chosen.size(), eta_text()));
      if (begins(i)) run(i);
    }
    return over();
  }

  SweepTally in_processes() {
    ::setenv("BENCH_COLUMNS", fmt::format("{}", terminal_columns(STDOUT_FILENO)).c_str(),
             1);  // of their tables
    auto next = sweep_.chosen.begin();
    bool stopping = false;
    do {
      stopping = stopping || interrupted().load() || tally_.try_again;
      if (interrupted().load()) jobs_.stop();
      while (!stopping && next != sweep_.chosen.end() &&
             jobs_.running() < static_cast<std::size_t>(sweep_.verb.jobs)) {
        const std::size_t i = *next++;
        if (begins(i)) jobs_.start(i, words_of(i));
      }
      for (const JobEnd& end : jobs_.ended()) take(end);
      line_.tell(fmt::format("[{}/{}] {} running  {:.0f} s  {}", done(), sweep_.chosen.size(),
                             jobs_.running(), now_s() - begin_s_, eta_text()));
      if (jobs_.running() > 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    } while (jobs_.running() > 0 || (!stopping && next != sweep_.chosen.end()));
    if (interrupted().load()) throw Interrupted{};
    return over();
  }

  std::size_t kept() const { return tally_.kept; }

 private:
  std::size_t done() const {
    return tally_.kept + tally_.in_use.size() + tally_.beyond_budget + n_refused_ + n_failed_;
  }

  /// From the mean of the runs of this call.
  std::string eta_text() const {
    if (n_run_ == 0) return "";
    const double left = static_cast<double>(sweep_.chosen.size() - done()) * (now_s() - begin_s_) /
                        static_cast<double>(n_run_);
    return fmt::format("eta of all {:.0f} s  ", left);
  }

  /// A line of the table.
  void print(const std::string& text) {
    line_.clear();
    show("{}\n", text);
    std::fflush(stdout);
  }

  /// Once in a sweep what holds for many of its cases.
  void tell(const std::string& text) {
    if (!told_.insert(text).second) return;
    line_.clear();
    say(text + "\n");
  }

  void keep(double core_s) {
    ++tally_.kept;
    spent_core_s_ += core_s;
  }

  /// The share of the budget that the cases of this call have.
  bool has_budget() const {
    const double share = sweep_.spec.budget.core_s * static_cast<double>(sweep_.chosen.size()) /
                         static_cast<double>(sweep_.spec.cases.size());
    return sweep_.spec.budget.core_s == 0 || sweep_.verb.index || spent_core_s_ < share;
  }

  /// Whether case i has to be run now. One that cannot be is refused.
  bool begins(std::size_t i) {
    try {
      const RunConfig config = resolved(sweep_.spec, sweep_.spec.cases[i]);
      const std::string why = why_to_run(sweep_, i, config);
      if (why.empty()) {
        const auto record =
            sweep_.spec.budget.core_s > 0 ? read_run(sweep_.folder(i) / "run.json") : std::nullopt;
        keep(record ? core_seconds(*record) : 0);
        remove_dead_lock(sweep_.folder(i));
        print(fmt::format("{:<44} already there", sweep_.note(i)));
        return false;
      }
      if (!has_budget()) {
        ++tally_.beyond_budget;
        return false;
      }
      for (const std::string& caveat : formula_caveats(config)) tell(caveat);
      if (why != "nothing") print(fmt::format("{:<44} runs again: {}", sweep_.note(i), why));
      return true;
    } catch (const ConfigError& error) {
      refuse(i, error);
      return false;
    }
  }

  void refuse(std::size_t i, const ConfigError& error) {
    refused_row(i);
    for (Violation v : error.violations()) {
      v.where = sweep_.verb.spec + " [" + sweep_.spec.cases[i].label + "] " + v.where;
      tally_.violations.push_back(std::move(v));
    }
  }

  void refused_row(std::size_t i) {
    tally_.refused[i] = true;
    ++n_refused_;
    std::error_code unreachable;
    const bool earlier = std::filesystem::exists(sweep_.folder(i) / "run.json", unreachable);
    print(fmt::format("{:<44} no record{}", sweep_.note(i),
                      earlier ? "; the one of an earlier sweep stays" : ""));
  }

  void run(std::size_t i) {
    RunOptions options = case_options(sweep_, i);
    options.progress = [this](const Progress& progress) { line_.show(progress); };
    options.tell = [this](const std::string& text) { tell(text); };
    try {
      const RunRecord record = run_config(resolved(sweep_.spec, sweep_.spec.cases[i]), options);
      ++n_run_;
      keep(core_seconds(record));
      print(summary_row(record));
      const std::size_t columns = terminal_columns(STDOUT_FILENO);
      if (record.status.outcome != Outcome::ok) print(wrapped("  " + record.status.detail, columns, 4));
    } catch (const EarlierStays& stays) {
      keep(0);
      print(fmt::format("{:<44} {}", sweep_.note(i), stays.kept));
    } catch (const FolderInUse& held) {
      tally_.in_use.push_back(i);
      print(fmt::format("{:<44} {}", sweep_.note(i), held.what()));
    } catch (const ConfigError& error) {
      refuse(i, error);
    }
  }

  /// The command that runs case i alone.
  std::vector<std::string> words_of(std::size_t i) const {
    const SweepVerb& verb = sweep_.verb;
    std::vector<std::string> out{"sweep", verb.spec,           "--index",    std::to_string(i),
                                 "--out", sweep_.out.string(), "--progress", "none"};
    for (const std::string& set : verb.set) out.insert(out.end(), {"--set", set});
    for (const std::string& plugin : sweep_.common.plugins) out.insert(out.end(), {"--plugin", plugin});
    if (!sweep_.common.blas_kernel.empty())
      out.insert(out.end(), {"--blas-kernel", sweep_.common.blas_kernel});
    if (verb.again) out.push_back("--again");
    if (verb.keep_inputs) out.push_back("--keep-inputs");
    if (verb.limits.resume) out.push_back("--resume");
    if (verb.limits.time_limit_s > 0)
      out.insert(out.end(), {"--time-limit", fmt::format("{}", verb.limits.time_limit_s)});
    if (verb.limits.step_limit > 0)
      out.insert(out.end(), {"--step-limit", std::to_string(verb.limits.step_limit)});
    return out;
  }

  /// What the process of a case left. Its row is what it printed below the head of its table.
  void take(const JobEnd& end) {
    std::string row = end.out;
    if (const std::string head = summary_header() + "\n"; row.starts_with(head)) row.erase(0, head.size());
    while (row.ends_with('\n')) row.pop_back();
    const std::size_t i = end.index;
    if (end.code == exit_ok) {
      ++n_run_;
      const auto record =
          sweep_.spec.budget.core_s > 0 ? read_run(sweep_.folder(i) / "run.json") : std::nullopt;
      keep(record ? core_seconds(*record) : 0);
      print(row);
      return;
    }
    if (interrupted().load()) return;  // a stop was requested
    if (end.code == exit_bad_input) {
      refused_row(i);
      tally_.complaints += end.err;
    } else if (end.code == exit_try_again && end.err.find(made_by_others) != std::string::npos) {
      tally_.in_use.push_back(i);
      print(row);
    } else {
      ++n_failed_;
      const bool may_go = end.code == exit_try_again || end.code == -SIGKILL || end.code == -SIGTERM;
      (may_go ? tally_.try_again : tally_.failed) = true;
      const std::string how = end.code < 0
                                  ? fmt::format("killed by signal {} ({})", -end.code, ::strsignal(-end.code))
                                  : fmt::format("ended with {}", end.code);
      print(fmt::format("{:<44} no record: its process {}", sweep_.note(i), how));
      tally_.complaints += fmt::format("{}: its process {}\n{}", sweep_.note(i), how, end.err);
    }
  }

  /// Another look at what others were at.
  SweepTally over() {
    std::vector<std::size_t> still;
    for (const std::size_t i : tally_.in_use) {
      const bool is_there = why_to_run(sweep_, i, resolved(sweep_.spec, sweep_.spec.cases[i])).empty();
      is_there ? keep(0) : still.push_back(i);
    }
    tally_.in_use = still;
    return tally_;
  }

  const Sweep& sweep_;
  SweepTally tally_;
  std::set<std::string> told_;
  ProgressLine line_;
  Jobs jobs_;
  double begin_s_, spent_core_s_ = 0;
  std::size_t looked_at_ = 0, n_run_ = 0, n_refused_ = 0, n_failed_ = 0;
};

}  // namespace

SweepTally run_sweep_cases(const Sweep& sweep) {
  SweepRun run(sweep);
  try {
    return sweep.verb.jobs > 1 ? run.in_processes() : run.here();
  } catch (const Interrupted&) {
    throw Interrupted{fmt::format(
        "{} of {} records kept in {}; the same command runs the rest, and goes on from the checkpoint of "
        "what was stopped",
        run.kept(), sweep.chosen.size(), sweep.out.string())};
  }
}

}  // namespace bb::cli
