// A measured number that can be absent: JSON has no NaN and no infinity, so a missing value carries the word
// that reports why, and the writer emits null plus "<name>_status".
#pragma once

#include <cmath>
#include <limits>

namespace bb {

/// A double, or the reason why there is none. Assigning a non-finite double names it by itself.
struct Number {
  double value = std::numeric_limits<double>::quiet_NaN();
  const char* status = "not_measured";  // nullptr exactly when value is finite; static storage

  Number() = default;
  Number(double v)
      : value(v), status(word(v)) {}  // NOLINT(google-explicit-constructor): meant to be implicit
  /// No value, with its reason ("no_contacts", "not_due", ...); `why` must outlive the record (a literal).
  static Number missing(const char* why) {
    Number n;
    n.status = why;
    return n;
  }
  bool finite() const { return status == nullptr; }

 private:
  static const char* word(double v) {
    if (std::isfinite(v)) return nullptr;
    if (std::isnan(v)) return "nan";
    return v > 0 ? "infinite" : "minus_infinite";
  }
};

/// Keeps the smaller, the larger, of two numbers that are there; of two that are not, the reason of the other.
inline void keep_smaller(Number& kept, const Number& other) {
  if (!kept.finite() || (other.finite() && other.value < kept.value)) kept = other;
}
inline void keep_larger(Number& kept, const Number& other) {
  if (!kept.finite() || (other.finite() && other.value > kept.value)) kept = other;
}

}  // namespace bb
