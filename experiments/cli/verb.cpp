#include "experiments/cli/verb.hpp"

namespace bb::cli {

const std::vector<Verb>& verbs() {
#define BB_VERB(name, group, doc, example) {#name, #group, doc, example, verb::name},
  static const std::vector<Verb> all{
#include "experiments/cli/verbs.inc"
  };
#undef BB_VERB
  return all;
}

}  // namespace bb::cli
