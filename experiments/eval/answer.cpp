// Writing numbers so that they read back to the same bits.
#include "experiments/eval/answer.hpp"

#include <charconv>
#include <cmath>

namespace bb::eval {

void Answer::key(std::string_view name) {
  if (!text_.empty()) text_ += ',';
  text_ += '"';
  text_ += name;
  text_ += "\":";
}

void Answer::value(double v) {
  if (!std::isfinite(v)) {
    if (non_finite_.empty() || std::isnan(v)) non_finite_ = std::isnan(v) ? "nan" : "infinite";
    text_ += "null";
    return;
  }
  char digits[32];
  const auto end = std::to_chars(digits, digits + sizeof digits, v == 0 ? 0.0 : v).ptr;  // never -0
  const std::string_view shortest(digits, static_cast<std::size_t>(end - digits));
  text_ += shortest;
  if (shortest.find_first_of(".e") == std::string_view::npos) text_ += ".0";
}

void Answer::number(std::string_view name, double v) {
  key(name);
  value(v);
}

void Answer::null(std::string_view name) {
  key(name);
  text_ += "null";
}

void Answer::flag(std::string_view name, bool v) {
  key(name);
  text_ += v ? "true" : "false";
}

void Answer::word(std::string_view name, std::string_view v) {
  key(name);
  text_ += '"';
  text_ += v;
  text_ += '"';
}

void Answer::list(std::string_view name, const std::vector<double>& values) {
  key(name);
  text_ += '[';
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) text_ += ',';
    value(values[i]);
  }
  text_ += ']';
}

std::string Answer::fields() const {
  const std::string_view word = status_.empty() ? non_finite_ : std::string_view(status_);
  if (word.empty()) return text_;
  return text_ + (text_.empty() ? "" : ",") + "\"status\":\"" + std::string(word) + '"';
}

}  // namespace bb::eval
