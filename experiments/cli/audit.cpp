// The verb audit: frames from the standard input before the exact audit.
#include <iostream>

#include "experiments/cli/options.hpp"
#include "experiments/judge/judge.hpp"

namespace bb::cli {

Action verb::audit(CLI::App& app) {
  const auto path = std::make_shared<std::string>();
  app.add_option("subject", *path, "JSON (barrierbench.subject/1): topology, obstacles, thickness")
      ->required();
  return [path](const CommonOptions&) {
    const judge::Subject subject = judge::read_subject(*path);
    return judge::judge(subject, std::cin, std::cout).clean ? exit_ok : exit_not_clean;
  };
}

}  // namespace bb::cli
