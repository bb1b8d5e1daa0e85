// The table of kinds: name -> the two instantiations of its function.
#pragma once

#include "experiments/eval/answer.hpp"
#include "experiments/eval/query.hpp"

namespace bb::eval {

/// Reads every field, calls query.finish(), then computes. Errors: ConfigError.
namespace answer {
#define ENTRY(name, doc) \
  template <class T>     \
  Answer name(Query& query);
#include "experiments/eval/registry.inc"
#undef ENTRY
}  // namespace answer

/// Instantiates a kind for both precisions; at the end of the file that defines it.
#define BB_EVAL_KIND(name)                      \
  template Answer answer::name<double>(Query&); \
  template Answer answer::name<float>(Query&)

}  // namespace bb::eval
