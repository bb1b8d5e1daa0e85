#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "core/base/parameters/check.hpp"
#include "core/base/parameters/registry.hpp"
#include "core/base/record/schema.hpp"
#include "core/math/error.hpp"
#include "core/step_solvers/registry.hpp"
#include "experiments/cli/options.hpp"
#include "experiments/cli/say.hpp"
#include "experiments/cli/terminal.hpp"
#include "experiments/config/config_list.hpp"

namespace bb::cli {
namespace {

struct Format {
  const char* name;
  ParameterList (*list)();      // of what is read
  std::string (*dictionary)();  // of what is written, and its schema
  std::string (*schema)();
};
constexpr std::array formats{Format{"config", config_list, nullptr, nullptr},
                             Format{"sweep", sweep_list, nullptr, nullptr},
                             Format{"record", nullptr, [] { return run_dictionary(step_solver_counters()); },
                                    [] { return run_schema(step_solver_counters()); }},
                             Format{"trace", nullptr, trace_dictionary, trace_schema}};

/// The default as it would be given, or in words, or that there has to be a value, or nothing.
std::string default_text(const Parameter& row) {
  if (row.rule.required) return "required";
  if (!row.rule.computed.empty()) return row.rule.computed;
  return to_text(row.fallback);
}

constexpr std::size_t text_column = 29;

/// Name, default and what is allowed; below it what it means.
void print_setting(const Parameter& row) {
  print_wrapped(fmt::format("  {:<26} {:<24} {}", row.name, default_text(row), allowed_text(row.rule)),
                text_column);
  if (!row.doc.empty()) print_wrapped(fmt::format("  {:<26} {}", "", row.doc), text_column);
}

/// One line a setting, below the doc of the object that holds it.
void print_list(const std::string& pointer, const ParameterList& list) {
  print_wrapped(fmt::format("\n{}: {}", pointer.empty() ? "/" : pointer, list.doc), 4);
  for (const Parameter& row : list.rows) {
    if (!row.rule.list || row.rule.kind == Kind::word) print_setting(row);
  }
  for (const Parameter& row : list.rows) {
    if (!row.rule.list) continue;
    print_list(pointer + "/" + row.name + (row.rule.kind == Kind::objects ? "/N" : ""),
               row.rule.list(nlohmann::json::object()));
  }
}

/// The settings at a JSON pointer into a format that is read and below it; an element of a list is its number, or N. Errors:
/// ConfigError for a place that is not there, with the settings of the object that it would be in.
void print_at(const std::string& format, ParameterList list, const std::string& pointer) {
  std::string place;
  for (std::size_t at = 0; at < pointer.size();) {
    const std::size_t end = std::min(pointer.find('/', at + 1), pointer.size());
    const std::string key = pointer.substr(at + 1, end - at - 1);
    at = end;
    const bool is_element =
        !key.empty() && (key == "N" || key.find_first_not_of("0123456789") == std::string::npos);
    if (is_element && place.ends_with("/N")) continue;
    const Parameter* row = find_named(list.rows, key);
    if (row == nullptr) throw unknown_name("help " + format + " " + pointer, key, names_of(list.rows));
    place += "/" + key;
    if (row->rule.list && (row->rule.kind != Kind::word || at < pointer.size())) {
      if (row->rule.kind == Kind::objects) place += "/N";
      const std::string doc = row->doc;
      list = row->rule.list(nlohmann::json::object());
      if (list.doc.empty()) list.doc = doc;
      continue;
    }
    if (at < pointer.size())
      throw ConfigError("help " + format + " " + pointer, pointer.substr(at),
                        "nothing below " + place + ", which is one setting");
    show("{} of a {}: default, what is allowed; below it what it means\n", place, format);
    return print_setting(*row);
  }
  show("settings of a {} from {} on: name, default, what is allowed; below it what it means\n", format,
       place);
  print_list(place, list);
}

/// Every setting of a format that is read, every field of one that is written, with what it means; or the
/// JSON Schema of it. Errors: ConfigError for another format.
int help(const std::string& format, const std::string& pointer, bool schema) {
  const Format* known = find_named(formats, format);
  if (known == nullptr) {
    std::vector<std::string> names = names_of(formats);
    for (const std::string& name : typed_names()) {
      if (find_named(formats, name) == nullptr) names.push_back(name);
    }
    throw unknown_name("help", format, names);
  }
  if (!pointer.empty()) {
    if (known->list == nullptr || schema || !pointer.starts_with('/'))
      throw ConfigError("help", fmt::format("{} {}", format, pointer),
                        "a JSON pointer such as /scene/obstacles into a config or a sweep, without --schema");
    print_at(format, known->list(), pointer);
    return exit_ok;
  }
  if (known->dictionary != nullptr) {
    fmt::print("{}", schema ? known->schema() : known->dictionary());
    return exit_ok;
  }
  if (schema) {
    fmt::print("{}\n", schema_document(format).dump(1));
    return exit_ok;
  }
  show("every setting of a {}: name, default, what is allowed; below it what it means\n", format);
  print_list("", known->list());
  return exit_ok;
}

}  // namespace

Action verb::help(CLI::App& app) {
  struct Given {
    std::string format = "config", pointer;
    bool schema = false;
  };
  const auto given = std::make_shared<Given>();
  app.add_option("format", given->format,
                 fmt::format("which file: {}; a JSON pointer is one into a config; a verb: as VERB --help",
                             fmt::join(names_of(formats), ", ")));
  app.add_option("pointer", given->pointer, "only what is there, e.g. /scene/obstacles");
  app.add_flag("--schema", given->schema, "print the JSON Schema instead");
  return [given](const CommonOptions&) {
    const bool is_pointer = given->format.starts_with('/') && given->pointer.empty();
    return is_pointer ? cli::help("config", given->format, given->schema)
                      : cli::help(given->format, given->pointer, given->schema);
  };
}

}  // namespace bb::cli
