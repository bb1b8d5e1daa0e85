// Published methods in one piece, configs/methods/NAME.json: settings by pointer, why each is as it is, and what this program
// does otherwise than the publication. Its friction is a file of its own, configs/methods/friction/NAME.json, of the same
// form: settings of /friction that count where a coefficient is above 0.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/config/run_config.hpp"

namespace bb {

using Texts = std::map<std::string, std::string>;

struct PublishedMethod {
  std::string name, doc, source;
  nlohmann::json set;  // pointer -> value
  Texts because;       // pointer -> the fact that it follows
  Texts differs;       // subject -> what is not as published
};

/// The settings of /friction (key -> value) that a method has; empty: its publication states nothing that is here.
nlohmann::json friction_of_method(const std::string& name);

/// Those of the folder, in the order of the alphabet.
std::vector<std::string> method_names();
/// Errors: ConfigError for a file that is not one of a method: file#/pointer, found, allowed.
PublishedMethod load_method(const std::string& name);
/// The same with its file of friction, where it has one.
PublishedMethod with_friction(PublishedMethod method);
std::vector<PublishedMethod> published_methods();

/// Pointers to the numbers, words and flags of a method, those inside the objects that it sets too.
std::map<std::string, nlohmann::json> leaves_of(const PublishedMethod& method);
/// Those that a resolved config has otherwise. Of a section that is not enabled none counts.
std::vector<std::string> overridden(const PublishedMethod& method, const nlohmann::json& resolved);

/// The method of a config and what of it the config overrides.
struct MethodUse {
  PublishedMethod method;
  std::vector<std::string> overridden;
  /// NAME, or `NAME, changed`: a run that overrides a setting is of no published method.
  std::string title() const { return method.name + (overridden.empty() ? "" : ", changed"); }
};
/// Precondition: config.method is not empty.
MethodUse method_use(const RunConfig& config);

}  // namespace bb
