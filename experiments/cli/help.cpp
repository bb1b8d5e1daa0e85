#include <fmt/format.h>

#include "barriers/named_entries.hpp"
#include "core/record/schema.hpp"
#include "experiments/cli/verbs.hpp"

namespace bb::cli {
namespace {

struct Format {
  const char* name;
  std::string (*text)();
  std::string (*schema)();
};
constexpr Format formats[] = {{"record", run_dictionary, run_schema},
                              {"trace", trace_dictionary, trace_schema}};

}  // namespace

std::vector<std::string> help_formats() {
  std::vector<std::string> names;
  for (const Format& format : formats) names.emplace_back(format.name);
  return names;
}

int help(const std::string& format, bool schema) {
  for (const Format& known : formats) {
    if (format != known.name) continue;
    fmt::print("{}", schema ? known.schema() : known.text());
    return exit_ok;
  }
  throw unknown_name("help", format, help_formats());
}

}  // namespace bb::cli
