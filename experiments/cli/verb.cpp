#include "experiments/cli/verb.hpp"

#include <algorithm>

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

}  // namespace bb::cli
