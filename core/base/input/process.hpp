// Another program, run once for an answer.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace bb {

struct Finished {
  int code = -1;    // exit code; 128 + number of the signal that ended it
  std::string out;  // its standard output and error, in the order they came
};

/// Starts words[0] with the other words, this environment and `more` of it, writes `in` to its standard input
/// (at most 4096 bytes, which a pipe holds) and waits for its end.
/// Errors: std::runtime_error where it cannot be started.
Finished run_process(const std::vector<std::string>& words, const std::string& in,
                     const std::vector<std::pair<std::string, std::string>>& more);

}  // namespace bb
