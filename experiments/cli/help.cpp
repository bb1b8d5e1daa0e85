#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "core/math/error.hpp"
#include "core/newton/step_solver.hpp"
#include "core/parameters/check.hpp"
#include "core/parameters/registry.hpp"
#include "core/record/schema.hpp"
#include "experiments/cli/options.hpp"
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

/// One line a setting, below the doc of the object that holds it.
void print_list(const std::string& pointer, const ParameterList& list) {
  fmt::print("\n{}: {}\n", pointer.empty() ? "/" : pointer, list.doc);
  for (const Parameter& row : list.rows) {
    if (row.rule.list && row.rule.kind != Kind::word) continue;
    fmt::print("  {:<26} {:<24} {}\n", row.name, default_text(row), allowed_text(row.rule));
    if (!row.doc.empty()) fmt::print("  {:<26} {}\n", "", row.doc);
  }
  for (const Parameter& row : list.rows) {
    if (!row.rule.list) continue;
    print_list(pointer + "/" + row.name + (row.rule.kind == Kind::objects ? "/N" : ""),
               row.rule.list(nlohmann::json::object()));
  }
}

/// Every setting of a format that is read, every field of one that is written, with what it means; or the
/// JSON Schema of it. Errors: ConfigError for another format.
int help(const std::string& format, bool schema) {
  const Format* known = find_named(formats, format);
  if (known == nullptr) throw unknown_name("help", format, names_of(formats));
  if (known->dictionary != nullptr) {
    fmt::print("{}", schema ? known->schema() : known->dictionary());
    return exit_ok;
  }
  if (schema) {
    fmt::print("{}\n", schema_document(format).dump(1));
    return exit_ok;
  }
  fmt::print("every setting of a {}: name, default, what is allowed; below it what it means\n", format);
  print_list("", known->list());
  return exit_ok;
}

}  // namespace

Action verb::help(CLI::App& app) {
  struct Given {
    std::string format = "config";
    bool schema = false;
  };
  const auto given = std::make_shared<Given>();
  app.add_option("format", given->format, fmt::format("which file: {}", fmt::join(names_of(formats), ", ")));
  app.add_flag("--schema", given->schema, "print the JSON Schema instead");
  return [given](const CommonOptions&) { return cli::help(given->format, given->schema); };
}

}  // namespace bb::cli
