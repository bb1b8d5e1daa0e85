#include <fstream>
#include <iostream>

#include "core/input/read_file.hpp"
#include "experiments/cli/verbs.hpp"
#include "experiments/eval/eval.hpp"

namespace bb::cli {

int eval(const std::string& file, bool schema) {
  if (schema) {
    print_eval_schema(std::cout);
    return exit_ok;
  }
  if (file == "-") return run_eval(std::cin, std::cout, std::cerr);
  require_regular_file(file, query_file);
  std::ifstream in(file);
  return run_eval(in, std::cout, std::cerr);
}

}  // namespace bb::cli
