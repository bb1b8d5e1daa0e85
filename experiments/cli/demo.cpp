// The verb demo: the sweeps whose table and figures the README shows.
#include <fmt/format.h>

#include <filesystem>

#include "experiments/cli/options.hpp"
#include "experiments/cli/progress.hpp"
#include "experiments/config/parse.hpp"

namespace bb::cli {
namespace {

/// The sweeps of configs/sweeps/demo_*.json, one after the other.
int demo(const std::string& out, const CommonOptions& common) {
  const std::filesystem::path specs = std::filesystem::path(configs_folder()) / "sweeps";
  for (const char* name : {"demo_strip", "demo_pinned", "demo_article", "demo_drape", "demo_long"}) {
    SweepVerb verb;
    verb.spec = (specs / (std::string(name) + ".json")).string();
    verb.out = (std::filesystem::path(out) / name).string();
    if (const int code = sweep(verb, common); code != exit_ok) return code;
    fmt::print("\n");
  }
  return exit_ok;
}

}  // namespace

Action verb::demo(CLI::App& app) {
  const auto out = std::make_shared<std::string>("results/runs/demo");
  app.add_option("--out", *out, "folder of the records");
  return [out](const CommonOptions& common) { return install_interrupt(), cli::demo(*out, common); };
}

}  // namespace bb::cli
