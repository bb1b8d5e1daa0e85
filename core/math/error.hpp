// Bad input. Numerical outcomes are statuses, never exceptions.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace bb {

/// One violation: where (file, and JSON pointer or line), what was found, what is allowed.
struct Violation {
  std::string where;    // "configs/x.json#/time/dt_s" or "mesh.obj:12"
  std::string found;    // the value as written
  std::string allowed;  // "a number > 0", "one of log, cubic (did you mean cubic?)"
};

/// Thrown before the first step; carries every violation at once. what() is one line for each.
class ConfigError : public std::runtime_error {
 public:
  explicit ConfigError(std::vector<Violation> violations)
      : std::runtime_error(text(violations)), violations_(std::move(violations)) {}
  ConfigError(std::string where, std::string found, std::string allowed)
      : ConfigError(one(std::move(where), std::move(found), std::move(allowed))) {}
  const std::vector<Violation>& violations() const { return violations_; }

 private:
  static std::vector<Violation> one(std::string where, std::string found, std::string allowed) {
    std::vector<Violation> violations(1);
    violations[0].where = std::move(where);
    violations[0].found = std::move(found);
    violations[0].allowed = std::move(allowed);
    return violations;
  }
  static std::string text(const std::vector<Violation>& violations) {
    std::string out;
    for (const Violation& v : violations) {
      out += (out.empty() ? "" : "\n") + v.where + ": found " + v.found + "; allowed: " + v.allowed;
    }
    return out;
  }
  std::vector<Violation> violations_;
};

}  // namespace bb
