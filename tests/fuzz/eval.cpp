// Lines of `eval`: every line gets one line of JSON, and none an internal error.
#include "experiments/eval/eval.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/fuzz/target.hpp"

namespace {

/// A condition query names its rows by number and gets a matrix of the largest: thousands of rows cost seconds.
bool asks_for_a_large_matrix(const std::string& text) {
  if (text.find("cond") == std::string::npos && text.find("\\u") == std::string::npos) return false;
  int digits = 0, most = 0;
  for (const char c : text) {
    digits = c >= '0' && c <= '9' ? digits + 1 : 0;
    most = std::max(most, digits);
  }
  return most > 2;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text = bb::fuzz::text_of(data, size);
  if (asks_for_a_large_matrix(text)) return 0;
  std::istringstream in(text);
  std::ostringstream out, err;
  bb::run_eval(in, out, err);
  std::istringstream answers(out.str());
  for (std::string line; std::getline(answers, line);) {
    bb::fuzz::require(nlohmann::json::accept(line), "an answer that is no JSON");
    bb::fuzz::require(line.find("\"error\":\"internal") == std::string::npos, line.c_str());
  }
  return 0;
}
