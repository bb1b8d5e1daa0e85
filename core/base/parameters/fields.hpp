// Named fields that somebody hands in, read one by one. What is wrong, missing or unknown is collected, so that all of it can be
// reported at once. The interface only: whoever reads fields knows neither JSON nor where they come from.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/math/types.hpp"

namespace bb {

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

class Fields {
 public:
  Fields() = default;
  Fields(const Fields&) = delete;
  Fields& operator=(const Fields&) = delete;
  virtual ~Fields() = default;

  virtual bool has(std::string_view name) const = 0;
  /// Whether numbers are rounded to float, and computed with in float.
  virtual bool single() const = 0;
  /// Numbers, lists and row lists, rounded to the precision. What is wrong comes back as the smallest valid value, so that reading
  /// can go on.
  virtual double number(const char* name, const Range& range) = 0;
  /// size < 0: any length from 1.
  virtual std::vector<double> list(const char* name, int size, const Range& range) = 0;
  /// rows or cols < 0: any from 1, all rows equally long.
  virtual MatX<double> rows(const char* name, int rows, int cols) = 0;
  /// Adds a violation at /name.
  virtual void complain(const std::string& name, const std::string& found, const std::string& allowed) = 0;
  virtual bool wrong() const = 0;
  /// Throws ConfigError when a field was wrong, missing or never requested.
  virtual void finish() = 0;

  /// [3 x n] points, one a column.
  template <class T>
  Eigen::Matrix<T, 3, Eigen::Dynamic> points(const char* name, int n) {
    return rows(name, n, 3).transpose().cast<T>();
  }
};

}  // namespace bb
