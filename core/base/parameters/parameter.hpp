// One row of a list of parameters: name with unit, what is allowed, default, meaning. Sections of a config,
// scenes, mesh generators and the entries of registries are lists of such rows; reading, writing, checks,
// messages, JSON Schema and help come from them.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace bb {

/// monostate: no value.
using ParameterValue = std::variant<std::monostate, bool, std::int64_t, double, std::string,
                                    std::vector<double>, std::vector<std::string>>;
using ParameterMap = std::map<std::string, ParameterValue>;
inline constexpr std::monostate no_default{};

enum class Kind {
  boolean,
  integer,
  number,
  text,       // without control characters
  word,       // one of the words
  words,      // a list of words, each once
  integers,   // a list
  numbers,    // a list
  texts,      // a list of texts that are not empty
  vector,     // three numbers
  direction,  // three numbers, not all 0
  box,        // two vectors
  values,     // a list of anything
  object,     // ruled by a list of its own
  objects     // a list of them
};

struct ParameterList;

/// What is allowed.
struct Rule {
  Kind kind = Kind::number;
  std::string unit;  // "m", "1"; empty for what has none
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false, high_open = false;         // the bound itself is not allowed
  double least = 0;                                 // of the size of a number that is not 0
  std::size_t min_size = 0, max_size = 0;           // bytes of a text, elements of a list; 0: no bound
  std::function<std::vector<std::string>()> words;  // evaluated when needed: plugins add names
  bool names = false;                               // the words are names of a registry
  std::map<std::string, std::string> renamed;       // words of before: what is read in the place of each
  bool several_lines = false;                       // a text may have line ends and tabs
  std::function<ParameterList(const nlohmann::json&)>
      list;              // of an object, which may decide by what it holds; of one in the place of a word
  std::string or_text;   // object: what a string in its place names; whoever reads it puts an object there
  std::string computed;  // the default in words, where it depends on other settings
  bool required = false;
};

/// Of a number, with the sizes that its unit allows (units.hpp).
Rule positive(std::string unit);
Rule non_negative(std::string unit);
Rule any_number(std::string unit);
Rule number_in(double low, double high, std::string unit);  // both bounds allowed
Rule count(std::int64_t low, std::int64_t high);
Rule flag();
/// renamed: words of configs and records of before, and what is read in the place of each.
Rule word(std::vector<std::string> words, std::map<std::string, std::string> renamed = {});
Rule words(std::vector<std::string> words);
Rule any_text();
Rule text_up_to(std::size_t bytes);  // and not empty
Rule free_text();                    // of several lines
Rule texts();                        // a list of at least one, none of them empty
/// Of three numbers, each as of any_number.
Rule any_vector(std::string unit);
Rule direction();
/// A name of a registry, which plugins may extend.
Rule name_in(std::function<std::vector<std::string>()> names);

/// The same rule without its bounds, or with more. Above 0 means: of at least the size that the unit allows.
Rule open_low(Rule rule);
Rule open_high(Rule rule);
Rule required(Rule rule);
Rule computed(Rule rule, std::string default_in_words);

struct Parameter {
  std::string name;  // unit in the suffix
  Rule rule;
  ParameterValue fallback;  // no_default: a setting that is left out stays out
  std::string doc;
};

/// The rows of one object.
struct ParameterList {
  std::string doc;
  std::vector<Parameter> rows;
  bool open = false;  // other keys are allowed, with any value
  /// The keys that make up each form of the object, where there are several; `forms_text` names them.
  std::vector<std::vector<std::string>> forms;
  std::string forms_text;
};

/// "a number > 0 (m)", "one of a, b", ...
std::string allowed_text(const Rule& rule);
/// The value as it would stand in JSON.
std::string to_text(const ParameterValue& value);

/// Typed reading of a complete map. Precondition: the parameter is declared with that kind and has a value.
double number(const ParameterMap& parameters, const std::string& name);
int integer(const ParameterMap& parameters, const std::string& name);
bool boolean(const ParameterMap& parameters, const std::string& name);
const std::string& text(const ParameterMap& parameters, const std::string& name);
/// Nothing when it was left out.
std::optional<double> optional_number(const ParameterMap& parameters, const std::string& name);

/// What an entry of a registry is made with: of the given values those that its rows declare, each checked,
/// and the defaults of the others. Errors: ConfigError at where/NAME.
ParameterMap own_parameters(const std::vector<Parameter>& rows, const ParameterMap& given,
                            const std::string& where);

/// The rows of all entries of a registry, each once, its doc headed by the names of the entries that read it.
template <class Registry>
std::vector<Parameter> rows_of_all(const Registry& registry) {
  std::vector<Parameter> all;
  for (const auto& entry : registry) {
    for (Parameter row : entry.parameters) {
      bool known = false;
      for (Parameter& other : all) {
        if (other.name != row.name) continue;
        other.doc = std::string(entry.name) + ", " + other.doc;
        known = true;
      }
      row.doc = std::string(entry.name) + ": " + row.doc;
      if (!known) all.push_back(std::move(row));
    }
  }
  return all;
}

}  // namespace bb
