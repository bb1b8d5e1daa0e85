// JSON -> RunRecord, by the lists of fields. Unknown fields are left out; every other fault is named
// with its place.
#include <fmt/format.h>

#include <concepts>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "core/base/input/json.hpp"
#include "core/base/input/names.hpp"
#include "core/base/record/parse_record.hpp"
#include "core/base/record/writer.hpp"

namespace bb {
namespace {

using Json = nlohmann::ordered_json;

/// Where a value is, and whether the record may lack fields: one of an earlier version may.
struct Place {
  std::string at;
  bool may_lack = false;
  Place operator/(const std::string& name) const { return {at + "/" + name, may_lack}; }
};

[[noreturn]] void refuse(const Place& place, const Json& found, const std::string& allowed) {
  throw ConfigError(place.at, shortened(found.dump(-1, ' ', true, Json::error_handler_t::replace)), allowed);
}

/// The same text for as long as the program runs: a Number keeps its reason as a pointer.
const char* kept(const std::string& word) {
  static std::set<std::string> words;
  return words.insert(word).first->c_str();
}

void get(const Place& place, const Json& j, bool& out) {
  if (!j.is_boolean()) refuse(place, j, "true or false");
  out = j.get<bool>();
}
template <std::integral T>
void get(const Place& place, const Json& j, T& out) {
  if (!j.is_number_integer()) refuse(place, j, "an integer");
  const bool fits = j.is_number_unsigned() ? std::in_range<T>(j.get<std::uint64_t>())
                                           : std::in_range<T>(j.get<std::int64_t>());
  if (!fits) {
    refuse(place, j,
           fmt::format("an integer from {} to {}", std::numeric_limits<T>::min(),
                       std::numeric_limits<T>::max()));
  }
  out = j.get<T>();
}
void get(const Place& place, const Json& j, double& out) {
  if (!j.is_number()) refuse(place, j, "a number");
  out = j.get<double>();
}
void get(const Place& place, const Json& j, std::string& out) {
  if (!j.is_string()) refuse(place, j, "a string");
  out = j.get<std::string>();
}
void get(const Place& place, const Json& j, JsonText& out) {
  if (!j.is_object()) refuse(place, j, "an object");
  out.text = j.dump();
}
void get(const Place& place, const Json& j, PhaseTimes& out) {
  if (!j.is_object()) refuse(place, j, "an object");
  for (std::size_t i = 0; i < kPhases; ++i) {
    const std::string name = std::string(kPhaseNames[i]) + "_s";
    if (j.contains(name)) get(place / name, j[name], out.s[i]);
  }
}
void get(const Place& place, const Json& j, SolverCounts& out);
template <class E>
requires std::is_enum_v<E>
void get(const Place& place, const Json& j, E& out) {
  std::string words;
  for (int i = 0; i < n_words<E>; ++i) {
    out = static_cast<E>(i);
    if (j == to_string(out)) return;
    words += (i == 0 ? "" : ", ") + std::string(to_string(out));
  }
  refuse(place, j, "one of " + words);
}
template <Record T>
void get(const Place& place, const Json& j, T& out);
template <class T>
void get(const Place& place, const Json& j, std::vector<T>& out) {
  if (!j.is_array()) refuse(place, j, "an array");
  for (std::size_t i = 0; i < j.size(); ++i) get(place / std::to_string(i), j[i], out.emplace_back());
}
template <class T, std::size_t n>
void get(const Place& place, const Json& j, std::array<T, n>& out) {
  if (!j.is_array() || j.size() != n) refuse(place, j, fmt::format("an array of {}", n));
  for (std::size_t i = 0; i < n; ++i) get(place / std::to_string(i), j[i], out[i]);
}
template <class T>
void get(const Place& place, const Json& j, std::map<std::string, T>& out) {
  if (!j.is_object()) refuse(place, j, "an object");
  for (const auto& [key, value] : j.items()) {
    const std::string name = (Json::json_pointer() / key).to_string();  // a key may hold a slash
    get(Place{place.at + name, place.may_lack}, value, out[key]);
  }
}

/// A number, or null with a reason beside it.
Number number_of(const Place& place, const Json& object, const FieldText& field) {
  const Json& value = object[field.name];
  if (!value.is_null()) {
    double finite = 0;
    get(place / field.name, value, finite);
    return finite;
  }
  const std::string reason = std::string(field.name) + "_status";
  if (!object.contains(reason)) refuse(place / field.name, value, "a number, or null with a " + reason);
  std::string word;
  get(place / reason, object[reason], word);
  return Number::missing(kept(word));
}

BB_ONCE_A_TYPE void get_field(const Place& place, const Json& object, const FieldText& field, Number& out) {
  out = number_of(place, object, field);
}
/// The same with the infinity that a reason says.
double double_of(const Number& number) {
  const std::string_view reason = number.finite() ? "" : number.status;
  const double infinity = std::numeric_limits<double>::infinity();
  return reason == "infinite" ? infinity : reason == "minus_infinite" ? -infinity : number.value;
}
BB_ONCE_A_TYPE void get_field(const Place& place, const Json& object, const FieldText& field, double& out) {
  out = double_of(number_of(place, object, field));
}
void get(const Place& place, const Json& j, SolverCounts& out) {
  if (!j.is_object()) refuse(place, j, "an object");
  for (const auto& [name, value] : j.items()) {
    if (name.ends_with("_status")) continue;  // the reason of another
    out.values[name] = double_of(number_of(place, j, {name.c_str(), ""}));
  }
}
template <class T>
BB_ONCE_A_TYPE void get_field(const Place& place, const Json& object, const FieldText& field, T& out) {
  get(place / field.name, object[field.name], out);
}

/// Whether the object has it. Errors: ConfigError where it must.
BB_ONCE_A_TYPE bool present(const Place& place, const Json& object, const FieldText& field, bool optional) {
  if (object.contains(field.name)) return true;
  if (!optional && !place.may_lack) throw ConfigError(place.at + "/" + field.name, "nothing", field.doc);
  return false;
}

template <Record T>
void get(const Place& place, const Json& j, T& out) {
  if (!j.is_object()) refuse(place, j, "an object");
  for_each_field<T>([&](const FieldText& field, auto member) {
    if constexpr (std::is_member_object_pointer_v<decltype(member)>) {
      auto& value = out.*member;
      constexpr bool optional = std::is_same_v<decltype(value), std::optional<std::string>&>;
      if (present(place, j, field, optional)) get_field(place, j, field, value);
    }
  });
}
void get(const Place& place, const Json& j, std::optional<std::string>& out) { get(place, j, out.emplace()); }

using Parts = std::array<int, 3>;

/// Model, revision, addition; nothing when it is no version.
std::optional<Parts> parts_of(const Json& schema) {
  if (!schema.contains("version") || !schema["version"].is_string()) return {};
  Parts v{};
  char rest = 0;
  const auto text = schema["version"].get<std::string>();
  if (std::sscanf(text.c_str(), "%d.%d.%d%c", &v[0], &v[1], &v[2], &rest) != 3) return {};
  return v;
}

}  // namespace

std::optional<RunRecord> parse_run(const std::string& text, const std::string& source) {
  Json j;
  try {
    static_cast<void>(
        parse_json(text, source, LargeIntegers::rounded));  // judged here, read in its order below
    j = Json::parse(text);
  } catch (const ConfigError&) {
    return {};
  }
  if (!j.is_object() || !j.contains("schema") || !j["schema"].is_object()) return {};
  const Json& schema = j["schema"];
  if (schema.value("name", Json()) != run_schema_name) return {};
  Place place{source + "#", false};
  const auto ours = *parts_of(Json{{"version", run_schema_version}}),
             its = parts_of(schema).value_or(Parts{});
  if (its[0] != ours[0]) {
    refuse(place / "schema" / "version", schema.value("version", Json()),
           fmt::format("{}.x.y, the records that this program reads", ours[0]));
  }
  place.may_lack = its < ours;
  RunRecord record;
  get(place, j, record);
  return record;
}

TraceRow parse_trace_row(const std::string& text, const std::string& source) {
  static_cast<void>(parse_json(text, source, LargeIntegers::rounded));
  TraceRow row;
  get(Place{source + "#", false}, Json::parse(text), row);
  return row;
}

std::optional<RunRecord> read_run(const std::filesystem::path& file) {
  std::string text;
  try {
    text = read_input_file(file.string(), record_file);
  } catch (const ConfigError&) {
    return {};
  }
  return parse_run(text, file.string());
}

}  // namespace bb
