#include "experiments/config/weight_formula.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <cmath>

#include "core/math/error.hpp"

namespace bb {
namespace {

const char* const names = "x, y, z (m), numbers, _pi, _e, and the operators and functions of muparser";

/// Where a single = stands, which muparser takes for an assignment to x, y or z; npos: nowhere.
std::size_t assignment_in(const std::string& text) {
  const std::string before = "=!<>";
  for (std::size_t at = text.find('='); at != std::string::npos; at = text.find('=', at + 1)) {
    const bool second = at > 0 && before.find(text[at - 1]) != std::string::npos;
    const bool first = at + 1 < text.size() && text[at + 1] == '=';
    if (!second && !first) return at;
  }
  return std::string::npos;
}

class Formula {
 public:
  Formula(const std::string& text, const std::string& where) : text_(text), where_(where) {
    if (const std::size_t at = assignment_in(text); at != std::string::npos) {
      throw ConfigError(where, fmt::format("an assignment at position {} of \"{}\"", at, text),
                        "== for a comparison, and no assignment");
    }
    guarded([this] {
      for (int axis = 0; axis < 3; ++axis) parser_.DefineVar(std::string(1, "xyz"[axis]), &at_[axis]);
      parser_.SetExpr(text_);
      int values = 0;
      parser_.Eval(values);
      if (values == 1) return;
      throw ConfigError(where_, fmt::format("{} values of \"{}\"", values, text_), "one value");
    });
  }
  double at(const Vec3d& x) {
    at_ = x;
    double out = 0;
    guarded([&] { out = parser_.Eval(); });
    return out;
  }

 private:
  template <class F>
  void guarded(const F& use) {
    try {
      use();
    } catch (const mu::ParserError& error) {
      if (error.GetCode() == mu::ecUNASSIGNABLE_TOKEN) {
        throw ConfigError(
            where_,
            fmt::format("the name \"{}\" at position {} of \"{}\"", error.GetToken(), error.GetPos(), text_),
            names);
      }
      const std::string token =
          error.GetToken().empty() ? "" : fmt::format(", token \"{}\"", error.GetToken());
      throw ConfigError(
          where_, fmt::format("\"{}\", position {}{}: {}", text_, error.GetPos(), token, error.GetMsg()),
          fmt::format("a formula in {}", names));
    }
  }

  std::string text_, where_;
  Vec3d at_ = Vec3d::Zero();
  mu::Parser parser_;
};

}  // namespace

void require_weight_formula(const std::string& text, const std::string& where) {
  const Formula read(text, where);
}

std::vector<double> formula_weights(const std::string& text, const Positions& start,
                                    const std::string& where) {
  Formula formula(text, where);
  std::vector<double> out;
  for (Eigen::Index v = 0; v < start.cols(); ++v) {
    const Vec3d x = start.col(v);
    out.push_back(formula.at(x));
    if (out.back() >= 0 && out.back() <= 1) continue;
    const std::string found = std::isnan(out.back()) ? "not a number" : fmt::format("{}", out.back());
    throw ConfigError(
        where, fmt::format("{} at vertex {}, which starts at ({}, {}, {})", found, v, x[0], x[1], x[2]),
        "a number in [0, 1] at every vertex");
  }
  return out;
}

}  // namespace bb
