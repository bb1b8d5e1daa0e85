#include "experiments/config/formula_shapes.hpp"

#include <nlohmann/json.hpp>
#include <optional>

#include "barriers/formulas.hpp"

namespace bb {

void name_formula(nlohmann::json& section, const std::string& where, std::vector<Violation>& violations) {
  if (!section.is_object() || !section.contains("shape")) return;
  const nlohmann::json given = section["shape"];
  std::string text;
  std::optional<std::string> at_zero;
  if (given.is_object() && given.contains("formula")) {
    text = given["formula"].get<std::string>();
    if (given.contains("at_zero")) at_zero = given["at_zero"].get<std::string>();
  } else if (given.is_string() && is_formula(given.get_ref<const std::string&>())) {
    text = given.get_ref<const std::string&>().substr(formula_prefix.size());
  } else if (given.is_string()) {
    return;
  }
  section.erase("shape");
  if (text.empty() && given.is_object()) return;  // it has a violation already
  const std::string at = where + "/shape" + (given.is_object() ? "/formula" : "");
  try {
    section["shape"] = require_formula(text, at_zero, at).shape.name;
  } catch (const ConfigError& error) {
    violations.insert(violations.end(), error.violations().begin(), error.violations().end());
  }
}

}  // namespace bb
