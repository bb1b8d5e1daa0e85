#include <fmt/format.h>

#include <filesystem>

#include "experiments/cli/progress.hpp"
#include "experiments/cli/verbs.hpp"
#include "experiments/config/parse.hpp"

namespace bb::cli {

int run(const RunVerb& verb, const CommonOptions& common) {
  const RunConfig config = load_config(verb.config, verb.set);
  RunOptions options;
  options.folder = verb.out.empty() ? "results/runs/" + run_label(config) : verb.out;
  options.argv = common.argv;
  ProgressLine line(common.progress);
  options.progress = [&line](const Progress& progress) { line.show(progress); };
  options.interrupted = &interrupted();
  const RunRecord record = run_config(config, options);
  line.clear();
  fmt::print("{}\n{}\n", summary_header(), summary_row(record));
  if (!record.status.detail.empty()) fmt::print("  {}\n", record.status.detail);
  fmt::print("{}\n", (options.folder / "run.json").string());
  return exit_ok;
}

}  // namespace bb::cli
