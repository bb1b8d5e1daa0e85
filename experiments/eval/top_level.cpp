// A scanner that knows strings and brackets, and leaves everything else to the JSON parser.
#include "experiments/eval/top_level.hpp"

#include <cstddef>

namespace bb::eval {
namespace {

constexpr std::string_view kBlank = " \t\r\n";

std::size_t skip_blank(std::string_view s, std::size_t at) {
  at = s.find_first_not_of(kBlank, at);
  return at == std::string_view::npos ? s.size() : at;
}

/// Position after the string that starts at `at`.
std::size_t skip_string(std::string_view s, std::size_t at) {
  for (++at; at < s.size() && s[at] != '"'; ++at) {
    if (s[at] == '\\') ++at;
  }
  return at < s.size() ? at + 1 : s.size();
}

/// Position after the value that starts at `at`: the comma or bracket that closes it, at depth 0.
std::size_t skip_value(std::string_view s, std::size_t at) {
  int depth = 0;
  while (at < s.size()) {
    const char c = s[at];
    if (c == '"') {
      at = skip_string(s, at);
      continue;
    }
    if (depth == 0 && (c == ',' || c == '}' || c == ']')) break;
    depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
    ++at;
  }
  return at;
}

}  // namespace

std::vector<std::pair<std::string_view, std::string_view>> top_level_members(std::string_view s) {
  std::vector<std::pair<std::string_view, std::string_view>> out;
  std::size_t at = skip_blank(s, 0);
  if (at >= s.size() || s[at] != '{') return out;
  at = skip_blank(s, at + 1);
  while (at < s.size() && s[at] == '"') {
    const std::size_t name_end = skip_string(s, at);
    const std::string_view name = s.substr(at + 1, name_end - at - 2);
    at = skip_blank(s, name_end);
    if (at >= s.size() || s[at] != ':') return out;
    at = skip_blank(s, at + 1);
    const std::size_t end = skip_value(s, at);
    std::string_view value = s.substr(at, end - at);
    const std::size_t last = value.find_last_not_of(kBlank);
    if (last == std::string_view::npos) return out;
    out.emplace_back(name, value.substr(0, last + 1));
    if (end >= s.size() || s[end] != ',') return out;
    at = skip_blank(s, end + 1);
  }
  return out;
}

}  // namespace bb::eval
