// One answer, written as it is filled: fields in the order in which they are set. Numbers round-trip; what is
// not finite is null and gives the answer its status.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/math/types.hpp"

namespace bb::eval {

class Answer {
 public:
  void number(std::string_view name, double value);
  void null(std::string_view name);
  void flag(std::string_view name, bool value);
  void word(std::string_view name, std::string_view value);  // plain words only: nothing to escape
  void list(std::string_view name, const std::vector<double>& values);
  /// Row lists.
  template <class Derived>
  void matrix(std::string_view name, const Eigen::MatrixBase<Derived>& m) {
    key(name);
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
      text_ += i == 0 ? "[[" : ",[";
      for (Eigen::Index j = 0; j < m.cols(); ++j) {
        if (j > 0) text_ += ',';
        value(static_cast<double>(m(i, j)));
      }
      text_ += ']';
    }
    text_ += ']';
  }
  template <class Derived>
  void vector(std::string_view name, const Eigen::MatrixBase<Derived>& v) {
    std::vector<double> values;
    for (Eigen::Index i = 0; i < v.size(); ++i) values.push_back(static_cast<double>(v(i)));
    list(name, values);
  }

  /// Says it in place of what a non-finite number would say.
  void status(std::string_view word) { status_ = word; }
  /// The fields without the braces.
  std::string fields() const;

 private:
  void key(std::string_view name);
  void value(double v);

  std::string text_;
  std::string status_;
  std::string_view non_finite_;
};

}  // namespace bb::eval
