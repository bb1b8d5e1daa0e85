// One answer: fields in the order in which they are set. Numbers round-trip; what is not finite is null and
// gives the answer its status.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/math/types.hpp"

namespace bb::eval {

class Answer {
 public:
  void number(const char* name, double value);
  void null(const char* name);
  void flag(const char* name, bool value);
  void word(const char* name, std::string_view value);
  void list(const char* name, const std::vector<double>& values);
  /// Row lists.
  template <class Derived>
  void matrix(const char* name, const Eigen::MatrixBase<Derived>& m) {
    nlohmann::ordered_json& rows = fields_[name] = nlohmann::ordered_json::array();
    for (Eigen::Index i = 0; i < m.rows(); ++i) {
      nlohmann::ordered_json& row = rows.emplace_back(nlohmann::ordered_json::array());
      for (Eigen::Index j = 0; j < m.cols(); ++j) row.push_back(value(static_cast<double>(m(i, j))));
    }
  }
  template <class Derived>
  void vector(const char* name, const Eigen::MatrixBase<Derived>& v) {
    std::vector<double> values;
    for (Eigen::Index i = 0; i < v.size(); ++i) values.push_back(static_cast<double>(v(i)));
    list(name, values);
  }

  /// Says it in place of what a non-finite number would say.
  void status(std::string_view word) { status_ = word; }
  /// The fields as JSON, without the braces.
  std::string fields() const;

 private:
  nlohmann::ordered_json value(double v);

  nlohmann::ordered_json fields_ = nlohmann::ordered_json::object();
  std::string status_;
  std::string_view non_finite_;
};

}  // namespace bb::eval
