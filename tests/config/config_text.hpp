// Small configs as text, and what the parser reports of them.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/math/error.hpp"
#include "experiments/config/parse.hpp"

namespace bb::test {

using nlohmann::json;

/// A valid config without files: one registered scene.
inline json hang_config() {
  return {{"schema", "barrierbench.config/1"}, {"scene", {{"name", "hang"}}}, {"formulation", "log"}};
}

/// A valid config of one square given as a body, pinned at its top row.
inline json bodies_config() {
  return {{"schema", "barrierbench.config/1"},
          {"scene",
           {{"bodies",
             {{{"name", "cloth"},
               {"mesh", {{"generator", "grid"}, {"n_x", 2}, {"n_y", 2}}},
               {"pins", {{{"top_row", true}}}}}}}}},
          {"formulation", {{"name", "cubic"}, {"d_hat_m", 0.01}}},
          {"time", {{"dt_s", 0.01}, {"steps", 2}}}};
}

inline RunConfig parsed(const json& config, const std::vector<std::string>& overrides = {}) {
  return parse_config(config.dump(), "a.json", ".", overrides);
}

/// The violations of text that must not be accepted.
inline std::vector<Violation> violations_of(const std::string& text,
                                            const std::vector<std::string>& overrides = {}) {
  try {
    parse_config(text, "a.json", ".", overrides);
  } catch (const ConfigError& error) {
    return {error.violations().begin(), error.violations().end()};
  }
  ADD_FAILURE() << "accepted: " << text;
  return {};
}

/// Exactly one violation, at a.json#pointer, of this value, with this part in what is allowed.
inline void expect_violation(const json& config, const std::string& pointer, const std::string& found,
                             const std::string& allowed) {
  const std::vector<Violation> violations = violations_of(config.dump());
  ASSERT_EQ(violations.size(), 1u) << config;
  EXPECT_EQ(violations[0].where, "a.json#" + pointer);
  EXPECT_EQ(violations[0].found, found) << pointer;
  EXPECT_NE(violations[0].allowed.find(allowed), std::string::npos) << violations[0].allowed;
}

/// The config with one value set.
inline json with(json config, const std::string& pointer, const json& value) {
  if (config["formulation"].is_string() && pointer.starts_with("/formulation/")) {
    config["formulation"] = {{"name", config["formulation"]}};
  }
  config[json::json_pointer(pointer)] = value;
  return config;
}

}  // namespace bb::test
