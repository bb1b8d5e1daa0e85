// Typed access to the fields of one query. Every wrong, missing or unknown field is collected and reported at
// once by finish(). Keeps the JSON library out of the files that answer.
#pragma once

#include <cmath>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/math/error.hpp"
#include "core/math/types.hpp"

namespace bb::eval {

/// Values a number may take: finite, and above or at `low`, below `high`.
struct Range {
  double low, high;
  bool low_open, high_open;
  const char* text;
  bool contains(double v) const {
    return std::isfinite(v) && (low_open ? v > low : v >= low) && (high_open ? v < high : v <= high);
  }
};
inline constexpr double kInf = std::numeric_limits<double>::infinity();
inline constexpr Range kFinite{-kInf, kInf, true, true, "a finite number"};
inline constexpr Range kPositive{0, kInf, true, true, "a number > 0"};
inline constexpr Range kNonNegative{0, kInf, false, true, "a number >= 0"};
inline constexpr Range kUnitOpen{0, 1, true, true, "a number > 0 and < 1"};

template <class T>
using MatX = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

class Query {
 public:
  /// `single`: numbers are rounded to float first, and have to be in its range.
  Query(const nlohmann::json& object, bool single) : object_(object), single_(single) {}

  bool has(std::string_view name) const;
  std::string word(const char* name);
  /// One of `allowed`; the nearest is suggested. Returns the first of them when it is wrong.
  std::string choice(const char* name, const std::vector<std::string>& allowed);
  std::string choice_or(const char* name, const std::vector<std::string>& allowed);  // default: the first
  bool flag_or(const char* name, bool fallback);
  int integer(const char* name, int low, int high);

  /// Numbers, lists and row lists, rounded to the precision of the query. What is wrong comes back as the
  /// smallest valid value, so that reading can go on.
  double number(const char* name, const Range& range);
  double number_or(const char* name, const Range& range, double fallback);
  /// size < 0: any length from 1.
  std::vector<double> list(const char* name, int size, const Range& range);
  /// rows or cols < 0: any from 1, all rows equally long.
  MatX<double> rows(const char* name, int rows, int cols);
  std::vector<int> indices(const char* name, int high);

  /// [3 x n] points, one a column.
  template <class T>
  Eigen::Matrix<T, 3, Eigen::Dynamic> points(const char* name, int n) {
    return rows(name, n, 3).transpose().cast<T>();
  }

  /// Adds a violation at /name.
  void complain(const std::string& name, const std::string& found, const std::string& allowed);
  /// Throws ConfigError when a field was wrong, missing or never asked for.
  void finish();
  bool wrong() const { return !violations_.empty(); }

 private:
  const nlohmann::json* find(const char* name);  // marks it as known; complains when it is not there
  double checked(const nlohmann::json& value, const std::string& where, const Range& range);

  const nlohmann::json& object_;
  bool single_;
  std::set<std::string, std::less<>> known_{"id", "kind", "precision"};
  std::vector<Violation> violations_;
};

}  // namespace bb::eval
