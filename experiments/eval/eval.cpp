// The loop over lines: parse, dispatch, answer. One line's failure never reaches another.
#include "experiments/eval/eval.hpp"

#include <istream>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>
#include <set>
#include <string>

#include "experiments/eval/kinds.hpp"
#include "experiments/eval/top_level.hpp"

namespace bb {
namespace eval {
namespace {

using nlohmann::json;

using Function = Answer (*)(Query&);
struct Kind {
  Function in_double, in_float;
};

const std::map<std::string, Kind, std::less<>>& kinds() {
  static const std::map<std::string, Kind, std::less<>> table = {
#define ENTRY(name, doc) {#name, {answer::name<double>, answer::name<float>}},
#include "experiments/eval/registry.inc"
#undef ENTRY
  };
  return table;
}

std::vector<std::string> kind_names() {
  return {
#define ENTRY(name, doc) #name,
#include "experiments/eval/registry.inc"
#undef ENTRY
  };
}

std::string quoted(const std::string& text) {
  return json(text).dump(-1, ' ', false, json::error_handler_t::replace);
}

/// "found what at where; allowed: ..." of every violation.
std::string text_of(const ConfigError& error) {
  std::string out;
  for (const Violation& v : error.violations()) {
    const std::string where = v.where.starts_with('/') ? v.where : "/" + v.where;
    out += (out.empty() ? "found " : " | found ") + v.found + " at " + where + "; allowed: " + v.allowed;
  }
  return out;
}

struct Line {
  std::string id;      // as written; empty: none
  std::string fields;  // of the answer, without braces
  std::string error;   // empty: answered
};

/// Id and duplicate names come from the text itself: the parser rounds long numbers and drops duplicates.
void scan(std::string_view text, Line& line) {
  std::set<std::string> seen;
  std::string twice;
  for (const auto& [written, value] : top_level_members(text)) {
    const std::string name = json::parse("\"" + std::string(written) + "\"").get<std::string>();
    if (name == "id") line.id = value;
    if (!seen.insert(name).second) twice = name;
  }
  if (!twice.empty()) throw ConfigError("/" + twice, "the same field twice", "each field once");
}

Answer answer_of(const json& object) {
  Query head(object, false);
  const std::string name = head.choice("kind", kind_names());
  const bool single = head.choice_or("precision", {"double", "float"}) == "float";
  if (head.wrong()) head.finish();
  Query query(object, single);
  const Kind& kind = kinds().find(name)->second;
  return single ? kind.in_float(query) : kind.in_double(query);
}

Line answer_line(std::string_view text) {
  Line line;
  try {
    const json object = json::parse(text);
    if (!object.is_object()) throw ConfigError("/", "a line that is not an object", "one JSON object a line");
    scan(text, line);
    line.fields = answer_of(object).fields();
  } catch (
      const json::out_of_range& e) {  // a number that no double holds; the rest is sound JSON up to there
    try {
      scan(text, line);
    } catch (const ConfigError&) {  // the number is the news
    }
    line.error = std::string("found a number out of range; allowed: finite double precision; ") + e.what();
  } catch (const json::parse_error& e) {
    line.error = std::string("found a line that is not JSON; allowed: one JSON object a line; ") + e.what();
  } catch (const ConfigError& e) {
    line.error = text_of(e);
  } catch (const std::exception& e) {
    line.error = std::string("internal: ") + e.what();
  }
  return line;
}

std::string text_of(const Line& line) {
  if (!line.error.empty()) {
    return "{\"id\":" + (line.id.empty() ? "null" : line.id) + ",\"error\":" + quoted(line.error) + "}";
  }
  if (line.id.empty()) return "{" + line.fields + "}";
  return "{\"id\":" + line.id + "," + line.fields + "}";
}

}  // namespace
}  // namespace eval

int run_eval(std::istream& in, std::ostream& out, std::ostream& err) {
  std::size_t queries = 0, failed = 0;
  for (std::string text; std::getline(in, text);) {
    if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);  // byte order mark
    if (text.find_first_not_of(" \t\r") == std::string::npos) continue;
    const eval::Line line = eval::answer_line(text);
    ++queries;
    failed += line.error.empty() ? 0 : 1;
    out << eval::text_of(line) << '\n' << std::flush;
    if (!out) {
      err << "eval: the answers cannot be written\n";
      return 75;
    }
  }
  if (in.bad()) {  // a folder, a broken disk
    err << "eval: the queries cannot be read\n";
    return 2;
  }
  if (failed > 0) err << "eval: " << failed << " of " << queries << " queries could not be answered\n";
  return failed > 0 ? 2 : 0;
}

}  // namespace bb
