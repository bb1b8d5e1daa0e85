#include <fmt/format.h>

#include <fstream>
#include <iostream>

#include "core/math/error.hpp"
#include "experiments/cli/verbs.hpp"
#include "experiments/eval/eval.hpp"

namespace bb::cli {

int eval(const std::string& file, bool schema) {
  if (schema) {
    print_eval_schema(std::cout);
    return exit_ok;
  }
  if (file == "-") return run_eval(std::cin, std::cout, std::cerr);
  std::ifstream in(file);
  if (!in) throw ConfigError(file, "nothing readable", "a file of JSON Lines, or - for standard input");
  return run_eval(in, std::cout, std::cerr);
}

}  // namespace bb::cli
