// Typed access to the fields of one query. Every wrong, missing or unknown field is collected and reported at
// once by finish(). Keeps the JSON library out of the files that answer.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/parameters/fields.hpp"
#include "core/math/error.hpp"

namespace bb::eval {

class Query final : public Fields {
 public:
  /// `single`: numbers are rounded to float first, and have to be in its range.
  Query(const nlohmann::json& object, bool single) : object_(object), single_(single) {}

  bool has(std::string_view name) const override;
  bool single() const override { return single_; }
  std::string word(const char* name);
  /// One of `allowed`; the nearest is suggested. Returns the first of them when it is wrong.
  std::string choice(const char* name, const std::vector<std::string>& allowed);
  std::string choice_or(const char* name, const std::vector<std::string>& allowed);  // default: the first
  bool flag_or(const char* name, bool fallback);
  int integer(const char* name, int low, int high);

  double number(const char* name, const Range& range) override;
  double number_or(const char* name, const Range& range, double fallback);
  std::vector<double> list(const char* name, int size, const Range& range) override;
  MatX<double> rows(const char* name, int rows, int cols) override;
  std::vector<int> indices(const char* name, int high);

  void complain(const std::string& name, const std::string& found, const std::string& allowed) override;
  void finish() override;
  bool wrong() const override { return !violations_.empty(); }

 private:
  const nlohmann::json* find(const char* name);  // marks it as known; complains when it is not there
  double checked(const nlohmann::json& value, const std::string& where, const Range& range);

  const nlohmann::json& object_;
  bool single_;
  std::set<std::string, std::less<>> known_{"id", "kind", "precision"};
  std::vector<Violation> violations_;
};

}  // namespace bb::eval
