// The loop over lines: parse, dispatch, answer. One line's failure never reaches another.
#include "experiments/eval/eval.hpp"

#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>

#include "core/base/input/json.hpp"
#include "core/base/input/read_file.hpp"
#include "core/base/parameters/registry.hpp"
#include "experiments/eval/kinds.hpp"
#include "experiments/eval/top_level.hpp"

namespace bb {
namespace eval {
namespace {

using nlohmann::json;

using Function = Answer (*)(Query&);
struct Kind {
  std::string name, doc;
  Function in_double, in_float;
};

const Registry<Kind>& kinds() {
#define ENTRY(name, doc) {#name, doc, answer::name<double>, answer::name<float>},
  static const Registry<Kind> all({
#include "experiments/eval/registry.inc"
  });
#undef ENTRY
  return all;
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

/// JSON, numbers beyond the range of a double included.
bool is_value(std::string_view text) {
  static const std::regex number(R"(-?(0|[1-9][0-9]*)(\.[0-9]+)?([eE][+-]?[0-9]+)?)");
  return json::accept(text) || std::regex_match(text.begin(), text.end(), number);
}

/// Id and repeated names come from the text itself: the parser rounds long numbers and knows no names of its
/// own. Requires JSON whose strings are sound; an id that is no JSON, after an earlier fault, is none.
void scan(std::string_view text, Line& line) {
  std::set<std::string> seen;
  std::string twice;
  for (const auto& [written, value] : top_level_members(text)) {
    const std::string name = json::parse("\"" + std::string(written) + "\"").get<std::string>();
    if (name == "id" && is_value(value)) line.id = value;
    if (!seen.insert(name).second) twice = name;
  }
  if (!twice.empty()) throw ConfigError("/" + twice, "the same field twice", "each field once");
}

/// What the JSON reader refused; the id is still found where the grammar holds up to it.
void tell(const JsonError& error, std::string_view text, Line& line) {
  const Violation& wrong = error.violations().front();
  if (error.fault() == JsonFault::syntax) {
    line.error = "found a line that is not JSON; allowed: one JSON object a line; " + wrong.found;
    return;
  }
  line.error = error.fault() == JsonFault::number_range
                   ? "found a number out of range; allowed: finite double precision; " + wrong.found
                   : "found " + wrong.found + "; allowed: " + wrong.allowed;
  try {
    scan(text, line);
  } catch (const ConfigError& repeated) {
    if (error.fault() == JsonFault::repeated_key) line.error = text_of(repeated);
  } catch (const json::exception&) {  // bad escapes beyond the place of the error
  }
}

Answer answer_of(const json& object) {
  Query head(object, false);
  const std::string name = head.choice("kind", kinds().names());
  const bool single = head.choice_or("precision", {"double", "float"}) == "float";
  if (head.wrong()) head.finish();
  Query query(object, single);
  const Kind& kind = kinds().require(name, "/kind");
  return single ? kind.in_float(query) : kind.in_double(query);
}

Line answer_line(const std::string& text) {
  Line line;
  try {
    const json object = parse_json(text, "", LargeIntegers::rounded);  // an id may have any number of digits
    if (!object.is_object()) throw ConfigError("/", "a line that is not an object", "one JSON object a line");
    scan(text, line);
    line.fields = answer_of(object).fields();
  } catch (const JsonError& e) {
    tell(e, text, line);
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

/// std::getline with a bound: false at the end; `text` has max_query_bytes + 1 bytes of a line that is longer, and its rest
/// is passed over.
bool next_line(std::istream& in, std::string& text) {
  text.clear();
  for (char c = 0; in.get(c);) {
    if (c == '\n') return true;
    if (text.size() <= max_query_bytes) text.push_back(c);
  }
  return !text.empty();
}

Line too_long() {
  Line line;
  line.error =
      "found a line of more than " + std::to_string(max_query_bytes) + " bytes; allowed: at most that";
  return line;
}

}  // namespace
}  // namespace eval

int run_eval(std::istream& in, std::ostream& out, std::ostream& err) {
  std::size_t queries = 0, failed = 0;
  for (std::string text; eval::next_line(in, text);) {
    if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);  // byte order mark
    if (text.find_first_not_of(" \t\r") == std::string::npos) continue;
    const eval::Line line = text.size() > max_query_bytes ? eval::too_long() : eval::answer_line(text);
    ++queries;
    failed += line.error.empty() ? 0 : 1;
    out << eval::text_of(line) << '\n' << std::flush;
    if (!out) {
      err << "eval: the answers cannot be written\n";
      return 75;
    }
  }
  if (in.bad()) {  // a broken disk
    err << "eval: the queries cannot be read\n";
    return 2;
  }
  if (failed > 0) err << "eval: " << failed << " of " << queries << " queries could not be answered\n";
  return failed > 0 ? 2 : 0;
}

int run_eval(const std::string& file) {
  if (file == "-") return run_eval(std::cin, std::cout, std::cerr);
  require_regular_file(file, query_file);
  std::ifstream in(file);
  return run_eval(in, std::cout, std::cerr);
}

}  // namespace bb
