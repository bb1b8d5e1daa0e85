#include "experiments/eval/answer.hpp"

#include <cmath>

namespace bb::eval {

nlohmann::ordered_json Answer::value(double v) {
  if (std::isfinite(v)) return v == 0 ? 0.0 : v;  // never -0
  if (non_finite_.empty() || std::isnan(v)) non_finite_ = std::isnan(v) ? "nan" : "infinite";
  return nullptr;
}

void Answer::number(const char* name, double v) { fields_[name] = value(v); }
void Answer::null(const char* name) { fields_[name] = nullptr; }
void Answer::flag(const char* name, bool v) { fields_[name] = v; }
void Answer::word(const char* name, std::string_view v) { fields_[name] = v; }

void Answer::list(const char* name, const std::vector<double>& values) {
  nlohmann::ordered_json& list = fields_[name] = nlohmann::ordered_json::array();
  for (const double v : values) list.push_back(value(v));
}

std::string Answer::fields() const {
  nlohmann::ordered_json all = fields_;
  const std::string_view word = status_.empty() ? non_finite_ : std::string_view(status_);
  if (!word.empty()) all["status"] = word;
  const std::string text = all.dump();
  return text.substr(1, text.size() - 2);
}

}  // namespace bb::eval
