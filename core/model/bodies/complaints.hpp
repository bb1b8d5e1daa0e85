// Violations of what is reported of one body, obstacle or scene, under the place that they share.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "core/math/error.hpp"

namespace bb {

/// Appends violations that share a prefix.
struct Complaints {
  std::string prefix;
  std::vector<Violation>& out;

  void operator()(const std::string& what, std::string found, std::string allowed) const {
    out.push_back({prefix + what, std::move(found), std::move(allowed)});
  }
  /// Of a number that is not good, or not finite.
  void number(const std::string& what, double found, bool good, const std::string& allowed) const;
  /// Of a model that is none of these, and not "none", which makes no elements.
  void model(const std::string& what, const std::string& found, std::vector<std::string> names) const;
};

}  // namespace bb
