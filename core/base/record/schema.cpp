// Schema and dictionary are walks over the lists of fields: a $def for each record struct.
#include "core/base/record/schema.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <concepts>
#include <nlohmann/json.hpp>
#include <span>
#include <sstream>

#include "core/base/record/run_record.hpp"

namespace bb {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* changed_meaning = "x-changed-meaning";
constexpr const char* solver_counts = "SolverCounts";

std::vector<std::string> words_in(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), std::istream_iterator<std::string>()};
}

Json text_schema(const char* allowed) {
  if (*allowed == '^') return {{"type", "string"}, {"pattern", allowed}};
  return *allowed == '\0' ? Json{{"type", "string"}} : Json{{"enum", words_in(allowed)}};
}

template <class E>
Json enum_schema() {
  Json words = Json::array();
  for (int i = 0; i < n_words<E>; ++i) words.push_back(to_string(static_cast<E>(i)));
  return {{"enum", words}};
}

Json phases_schema() {
  Json properties = Json::object();
  for (std::size_t i = 0; i < kPhases; ++i) {
    properties[std::string(kPhaseNames[i]) + "_s"] = {{"type", "number"}, {"description", kPhaseDocs[i]}};
  }
  return {{"type", "object"},
          {"description", "seconds of every phase; a phase that took no time is left out"},
          {"properties", properties},
          {"additionalProperties", false}};
}

/// A step has those of its step solver alone.
Json counters_schema(const std::vector<SolverCounter>& counters) {
  Json properties = Json::object();
  for (const SolverCounter& counter : counters) {
    properties[counter.name] = {
        {"type", {"number", "null"}},
        {"description", counter.doc + "; over the steps the " + std::string(to_string(counter.over_steps))}};
    properties[counter.name + "_status"] = {{"enum", words_in(non_finite_words)}};
  }
  return {{"type", "object"},
          {"description", "counters of step solvers, each of those that its entry declares"},
          {"properties", properties},
          {"additionalProperties", false}};
}

template <class T>
Json record_schema(Json& defs);

/// Of a value of type T; `defs` gets the records in it.
template <class T>
BB_ONCE_A_TYPE Json schema_of(Json& defs, const FieldText& field) {
  const auto define = [&defs](const char* name, auto make) {
    if (!defs.contains(name)) {
      defs[name] = nullptr;  // keeps its place before those of its fields
      Json made = make();
      defs[name] = std::move(made);
    }
    return Json{{"$ref", std::string("#/$defs/") + name}};
  };
  if constexpr (std::same_as<T, bool>) {
    return {{"type", "boolean"}};
  } else if constexpr (std::integral<T>) {
    return {{"type", "integer"}, {"minimum", *field.allowed == '\0' ? 0 : std::stoi(field.allowed)}};
  } else if constexpr (std::same_as<T, Number> || std::same_as<T, double>) {
    return {{"type", {"number", "null"}}};
  } else if constexpr (std::same_as<T, std::string> || std::same_as<T, std::optional<std::string>>) {
    return text_schema(field.allowed);
  } else if constexpr (std::is_enum_v<T>) {
    return enum_schema<T>();
  } else if constexpr (std::same_as<T, JsonText>) {
    return {{"type", "object"}};
  } else if constexpr (std::same_as<T, PhaseTimes>) {
    return define("PhaseTimes", phases_schema);
  } else if constexpr (std::same_as<T, SolverCounts>) {
    return define(solver_counts, [] { return Json(); });  // run_document() knows which there are
  } else if constexpr (Record<T>) {
    return define(T::record_name, [&defs] { return record_schema<T>(defs); });
  } else if constexpr (requires { typename T::mapped_type; }) {
    return {{"type", "object"}, {"additionalProperties", schema_of<typename T::mapped_type>(defs, field)}};
  } else if constexpr (std::same_as<typename T::value_type, double>) {
    return {{"type", "array"}, {"items", {{"type", "number"}}}};
  } else {
    return {{"type", "array"}, {"items", schema_of<typename T::value_type>(defs, field)}};
  }
}

/// What a record holds: `reasons` are the words beside a number that is null, empty for what is not a number field.
struct Properties {
  Json all = Json::object(), required = Json::array();
  BB_ONCE_A_TYPE void add(const FieldText& field, Json schema, const char* reasons, bool optional) {
    schema["description"] = field.doc;
    all[field.name] = std::move(schema);
    if (*reasons != '\0') {
      const std::vector<std::string> words = words_in(std::string(field.allowed) + " " + reasons);
      all[std::string(field.name) + "_status"] = {{"enum", words}};
    }
    if (!optional) required.push_back(field.name);
  }
};

/// Words beside a null, of a field of type T; empty: it is none that may be null.
template <class T>
constexpr const char* reasons_of = "";
template <>
constexpr const char* reasons_of<Number> = absent_words;
template <>
constexpr const char* reasons_of<double> = non_finite_words;

template <class T>
Json record_schema(Json& defs) {
  Properties properties;
  for_each_field<T>([&](const FieldText& field, auto member) {
    using Value = std::remove_cvref_t<std::invoke_result_t<decltype(member), const T&>>;
    properties.add(field, schema_of<Value>(defs, field), reasons_of<Value>,
                   std::same_as<Value, std::optional<std::string>>);
  });
  return {{"type", "object"},
          {"description", T::record_doc},
          {"properties", properties.all},
          {"required", properties.required},
          {"additionalProperties", false}};
}

/// JSON text with a line for every field.
std::string lines(const Json& j, std::string indent) {
  const auto is_object = [](const Json& child) { return child.is_object(); };
  if (!j.is_object() || !(j.contains("properties") || std::all_of(j.begin(), j.end(), is_object))) {
    return j.dump();
  }
  std::string out;
  indent += ' ';
  for (const auto& [key, value] : j.items()) {
    out += (out.empty() ? "{\n" : ",\n") + indent + Json(key).dump() + ": " + lines(value, indent);
  }
  return out + "}";
}

/// Field -> what it meant before. Validators pass over a keyword that they do not know.
Json changes_of(std::span<const ChangedMeaning> changes) {
  Json out = Json::object();
  for (const ChangedMeaning& change : changes)
    out[change.field] = {{"since", change.since}, {"before", change.before}};
  return out;
}

template <class T>
Json document(const char* title, std::span<const ChangedMeaning> changes) {
  Json defs = Json::object();
  Json out = {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
              {"$comment", std::string("version ") + run_schema_version},
              {changed_meaning, changes_of(changes)},
              {"title", title}};
  out.update(record_schema<T>(defs));
  out["$defs"] = defs;
  return out;
}

Json run_document(const std::vector<SolverCounter>& counters) {
  Json out = document<RunRecord>("barrierbench run record", changed_in_run);
  out["$defs"][solver_counts] = counters_schema(counters);
  return out;
}
Json trace_document() { return document<TraceRow>("barrierbench trace line", changed_in_trace); }

std::string joined(const Json& words) {
  std::string out;
  for (const Json& word : words) out += (out.empty() ? "" : ", ") + word.get<std::string>();
  return out;
}

/// " [before 3.5.0: ...]" of a field that meant something else; empty for the others.
std::string earlier_meaning(const Json& document, const std::string& place) {
  const Json& changes = document[changed_meaning];
  const auto found = changes.find(place);
  if (found == changes.end()) return "";
  return fmt::format(" [before {}: {}]", (*found)["since"].get<std::string>(),
                     (*found)["before"].get<std::string>());
}

/// Appends a line for every field below `schema`.
void describe(const Json& document, const Json& schema, const std::string& place, std::string& out) {
  if (schema.contains("$ref")) {
    const auto ref = schema["$ref"].get<std::string>();
    return describe(document, document["$defs"].at(ref.substr(std::string("#/$defs/").size())), place, out);
  }
  if (schema.contains("items")) return describe(document, schema["items"], place + "[]", out);
  if (schema.contains("additionalProperties") && schema["additionalProperties"].is_object()) {
    return describe(document, schema["additionalProperties"], place + ".*", out);
  }
  if (!schema.contains("properties")) return;
  const Json& properties = schema["properties"];
  for (const auto& [name, field] : properties.items()) {
    if (!field.contains("description")) continue;  // the reason of another field
    const std::string at = place.empty() ? name : place + "." + name;
    out += fmt::format("{:<44} {:<6} {}", at, unit_of(name), field["description"].get<std::string>());
    if (field.contains("enum")) out += " [" + joined(field["enum"]) + "]";
    if (const auto reasons = properties.find(name + "_status"); reasons != properties.end()) {
      out += " [or null: " + joined((*reasons)["enum"]) + "]";
    }
    out += earlier_meaning(document, at) + "\n";
    describe(document, field, at, out);
  }
}

std::string dictionary(const Json& document) {
  std::string out;
  describe(document, document, "", out);
  return out;
}

}  // namespace

std::string run_schema(const std::vector<SolverCounter>& counters) {
  return lines(run_document(counters), "") + "\n";
}
std::string trace_schema() { return lines(trace_document(), "") + "\n"; }

std::string run_dictionary(const std::vector<SolverCounter>& counters) {
  return dictionary(run_document(counters));
}
std::string trace_dictionary() { return dictionary(trace_document()); }

std::string_view unit_of(std::string_view name) {
  constexpr std::pair<std::string_view, std::string_view> units[] = {
      {"_N_per_m", "N/m"}, {"_bytes", "bytes"}, {"_rel", "1"}, {"_m", "m"},
      {"_s", "s"},         {"_J", "J"},         {"_N", "N"}};
  for (const auto& [end, unit] : units) {
    if (name.ends_with(end)) return unit;
  }
  return {};
}

}  // namespace bb
