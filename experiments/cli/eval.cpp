#include <iostream>

#include "experiments/cli/options.hpp"
#include "experiments/eval/eval.hpp"

namespace bb::cli {

namespace {

int eval(const std::string& file, bool schema) {
  if (schema) {
    print_eval_schema(std::cout);
    return exit_ok;
  }
  return run_eval(file);
}

}  // namespace

Action verb::eval(CLI::App& app) {
  struct Given {
    std::string file = "-";
    bool schema = false;
  };
  const auto given = std::make_shared<Given>();
  app.add_option("file", given->file, "queries, - for standard input");
  app.add_flag("--schema", given->schema, "print the JSON Schema of all kinds");
  return [given](const CommonOptions&) { return cli::eval(given->file, given->schema); };
}

}  // namespace bb::cli
