#include "experiments/cli/verb.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>

namespace bb::cli {
namespace {

std::string hyphened(std::string word) {
  std::replace(word.begin(), word.end(), '_', '-');
  return word;
}

}  // namespace

const std::vector<Verb>& verbs() {
#define BB_VERB(word, group, name, doc, example) {hyphened(#word), #group, name, doc, example, verb::word},
  static const std::vector<Verb> all{
#include "experiments/cli/verbs.inc"
  };
#undef BB_VERB
  return all;
}

std::vector<std::string> typed_names() {
  std::vector<std::string> names;
  if (const char* of_front_door = std::getenv("BENCH_VERBS")) {
    std::istringstream words(of_front_door);
    for (std::string name; words >> name;) names.push_back(name);
  } else {
    for (const Verb& verb : verbs()) names.push_back(verb.name);
  }
  return names;
}

}  // namespace bb::cli
