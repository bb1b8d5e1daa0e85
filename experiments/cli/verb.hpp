// A verb of the program: its row of verbs.inc, and the function of its own file that declares its options.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "experiments/cli/verbs.hpp"

namespace CLI {
class App;
}

namespace bb::cli {

/// What a verb does once the command line is read; the exit code. Errors end in main.cpp.
using Action = std::function<int(const CommonOptions&)>;

/// Adds the options of a verb to its part of the command line.
namespace verb {
#define BB_VERB(word, group, name, doc, example) Action word(CLI::App& app);
#include "experiments/cli/verbs.inc"
#undef BB_VERB
}  // namespace verb

struct Verb {
  std::string name;   // the word of this program; a hyphen for _ of its row
  const char* group;  // run, look, study, judge, make, develop
  const char* typed;  // behind ./bench
  const char* doc;
  const char* example;
  Action (*declare)(CLI::App&);
};

/// In the order of verbs.inc.
const std::vector<Verb>& verbs();

/// What a user may type as the first word, for messages: the verbs of ./bench where it has started this program
/// (BENCH_VERBS), else those of this program.
std::vector<std::string> typed_names();

}  // namespace bb::cli
