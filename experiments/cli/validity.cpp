// The verb validity: the block of this build as a table.
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "experiments/cli/options.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/validity/stored_block.hpp"

namespace bb::cli {
namespace {

std::string number(const nlohmann::json& value) {
  return value.is_null() ? "-" : fmt::format("{:.2g}", value.get<double>());
}

}  // namespace

BuildValidity build_validity(const CommonOptions& common) {
  const StoredBlock block = block_of_this_build(validity_folder(), common.loaded);
  if (!block.validity.valid) {
    say(fmt::format("this build fails its validity block ({}): no times are shown; see ./bench validity\n",
                    block.validity.failed));
  }
  return block.validity;
}

namespace {

/// The checks of the block as a table, or the report itself; exit_wrong_answer when one failed.
int validity(bool as_json, const CommonOptions& common) {
  const StoredBlock block = block_of_this_build(validity_folder(), common.loaded);
  if (as_json) {
    show("{}", block.report);
  } else {
    const nlohmann::json report = nlohmann::json::parse(block.report);
    show("{:6} {:22} {:>8} {:>9} {:>9}  {}\n", "", "check", "subjects", "worst", "allowed", "what");
    for (const auto& check : report["checks"]) {
      show("{:6} {:22} {:>8} {:>9} {:>9}  {}\n", check["pass"] ? "passed" : "FAILED",
           check["name"].get<std::string>(), check["subjects"].get<long long>(), number(check["value"]),
           number(check["bound"]), check["meaning"].get<std::string>());
      if (const auto detail = check["detail"].get<std::string>(); !detail.empty())
        show("       {}\n", detail);
    }
    show("{} checks, {}; {}\n", block.validity.checks, block.validity.valid ? "all passed" : "not valid",
         block.kept ? block.file.string() : "not kept: the folder of the program cannot be written");
  }
  return block.validity.valid ? exit_ok : exit_wrong_answer;
}

}  // namespace

Action verb::validity(CLI::App& app) {
  const auto json = std::make_shared<bool>(false);
  app.add_flag("--json", *json, "the report as JSON");
  app.footer(
      "Made by the first run of a build and kept beside the program; a build that fails shows no times.\n" +
      app.get_footer());
  return [json](const CommonOptions& common) { return cli::validity(*json, common); };
}

}  // namespace bb::cli
