// The verb plan: the runs of a sweep, what is there of them and what the rest is expected to take. Runs nothing.
#include <fmt/format.h>

#include <array>
#include <mutex>

#include "core/math/error.hpp"
#include "experiments/cli/options.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/cli/sweep_cost.hpp"
#include "experiments/cli/sweep_folder.hpp"

namespace bb::cli {
namespace {

struct PlanVerb {
  SweepVerb sweep;
  std::vector<std::string> records;  // folders
  bool write = false;
};

constexpr std::array<const char*, 3> source_words = {"record", "records", "model"};
constexpr std::array<const char*, 3> source_texts = {
    "by a record of the run itself", "by records of the same scene, scaled by steps and unknowns",
    "by the model: 0.03 s, and 8 Newton iterations a step, each 4.5 us an unknown and a linear solve; a "
    "factor of 6 either way"};

/// What is expected of the runs that are not there.
struct Total {
  double core_s = 0, longest_s = 0;
  std::size_t runs = 0;
  std::array<std::size_t, 3> of_source{};
};

void print_total(const Sweep& sweep, const Total& total) {
  const SweepSpec& spec = sweep.spec;
  show("\n{}: {} runs ({}{}){}, {} there in {}, {} to make\n", spec.name, spec.cases.size(), spec.shape,
       spec.excluded > 0 ? fmt::format(", {} left out", spec.excluded) : "",
       sweep.whole() ? "" : fmt::format(", {} of them in this shard", sweep.chosen.size()),
       sweep.chosen.size() - total.runs, sweep.out.string(), total.runs);
  if (total.runs == 0) return;
  show("expected: {:.3g} core s, the longest run {:.3g}\n", total.core_s, total.longest_s);
  for (std::size_t s = 0; s < source_texts.size(); ++s) {
    if (total.of_source[s] > 0) show("  {} {}\n", total.of_source[s], source_texts[s]);
  }
  const double budget = spec.budget.core_s;
  if (budget > 0) {
    show("budget: {:g} core s, {}\n", budget,
         total.core_s <= budget ? "enough"
                                : fmt::format("{:.0f} % of what is expected", 100 * budget / total.core_s));
  }
}

/// Sizes of the scenes. Errors: ConfigError: of every case whose scene cannot be built.
void measure(const Sweep& sweep, CostBook& book, std::vector<RunSize>& sizes) {
  std::vector<Violation> violations;
  for (std::size_t i = 0; i < sizes.size() && violations.size() < max_violations; ++i) {
    const SweepCase& one = sweep.spec.cases[i];
    sizes[i].config_id = one.config_id;
    try {
      book.measure(sizes[i], [&] { return resolved(sweep.spec, one); });
    } catch (const ConfigError& error) {
      append_violations(sweep.verb.spec, one, error, violations);
    }
  }
  if (!violations.empty()) throw ConfigError(violations);
}

/// One line a run, and what is expected of those that are not there.
Total print_cases(const Sweep& sweep, const CostBook& book, const std::vector<RunSize>& sizes) {
  Total total;
  std::error_code none;
  const bool any_there = std::filesystem::exists(sweep.out, none);
  show("{:>6} {:<16} {:>9} {:<8} {}\n", "index", "config_id", "core_s", "by", "run");
  for (const std::size_t i : sweep.chosen) {
    const SweepCase& one = sweep.spec.cases[i];
    std::error_code unreachable;
    const bool has_record = any_there && std::filesystem::exists(sweep.folder(i) / "run.json", unreachable);
    const bool done = has_record && why_to_run(sweep, i, resolved(sweep.spec, one)).empty();
    const ExpectedCost cost = book.expected(sizes[i]);
    const auto source = static_cast<std::size_t>(cost.source);
    show("{:>6} {:<16} {:>9.3g} {:<8} {}\n", i, one.config_id.substr(0, 16), cost.core_s,
         done ? "there" : source_words[source], one.label);
    if (done) continue;
    ++total.runs;
    ++total.of_source[source];
    total.core_s += cost.core_s;
    total.longest_s = std::max(total.longest_s, cost.core_s);
  }
  return total;
}

int plan(const PlanVerb& verb, const CommonOptions& common) {
  CostBook book;
  for (const std::string& folder : verb.records) {
    if (!std::filesystem::is_directory(folder))
      throw ConfigError("--records", '"' + folder + '"', "a folder with records");
    book.add_records(folder);
  }
  std::vector<RunSize> sizes;
  std::mutex of_sizes;
  Sweep sweep =
      open_sweep(verb.sweep, common, [&](std::size_t i, const RunConfig& config, const std::string& scene) {
        RunSize size = size_of(config, scene);
        const std::lock_guard lock(of_sizes);
        if (sizes.size() <= i) sizes.resize(i + 1);
        sizes[i] = std::move(size);
      });
  measure(sweep, book, sizes);
  sweep.options.argv = common.argv;
  sweep.options.plugins = common.loaded;
  if (verb.records.empty()) book.add_records(sweep.out);
  if (verb.write) write_sweep_files(sweep);
  print_total(sweep, print_cases(sweep, book, sizes));
  return exit_ok;
}

}  // namespace

Action verb::plan(CLI::App& app) {
  const auto verb = std::make_shared<PlanVerb>();
  app.add_option("spec", verb->sweep.spec, "a sweep file, e.g. configs/sweeps/demo_strip.json")->required();
  set_argument(app, verb->sweep.set, "override in every case");
  app.add_option("--out", verb->sweep.out, "folder of the records (default results/runs/<name>)");
  app.add_option("--records", verb->records,
                 "a folder with records that costs are taken from (default: that of the sweep)")
      ->allow_extra_args(false);
  app.add_option("--shard", verb->sweep.shard, "i/N: the i-th of N shares alone");
  app.add_flag(
      "--write", verb->write,
      "keep the list in the folder, so that ./bench status knows runs of --index that have not begun");
  return [verb](const CommonOptions& common) { return cli::plan(*verb, common); };
}

}  // namespace bb::cli
