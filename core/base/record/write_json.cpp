// Records -> JSON, by their lists of fields.
#include <concepts>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/base/record/writer.hpp"

namespace bb {
namespace {

using Json = nlohmann::ordered_json;

/// Sets j[name]; a missing value is null plus j["<name>_status"], the reason.
BB_ONCE_A_TYPE void put(Json& j, const std::string& name, const Number& n) {
  if (n.finite()) {
    j[name] = n.value;
  } else {
    j[name] = nullptr;
    j[name + "_status"] = n.status;
  }
}

Json json_of(const PhaseTimes& times) {
  Json j = Json::object();
  for (std::size_t i = 0; i < kPhases; ++i) {
    if (times.s[i] != 0) put(j, std::string(kPhaseNames[i]) + "_s", times.s[i]);
  }
  return j;
}

Json json_of(const SolverCounts& counts) {
  Json j = Json::object();
  for (const auto& [name, value] : counts.values) put(j, name, Number(value));
  return j;
}

Json json_of(const JsonText& v) {
  Json j = Json::parse(v.text, nullptr, false);
  if (j.is_discarded()) throw std::invalid_argument("record: config is not JSON");
  return j;
}

template <class T>
Json json_of(const T& v) {
  return v;
}
template <class E>
requires std::is_enum_v<E> Json json_of(const E& v) { return to_string(v); }
template <Record T>
Json json_of(const T& v);
template <Record T>
Json json_of(const std::vector<T>& list) {
  Json j = Json::array();
  for (const T& v : list) j.push_back(json_of(v));
  return j;
}
template <Record T>
Json json_of(const std::map<std::string, T>& map) {
  Json j = Json::object();
  for (const auto& [key, v] : map) j[key] = json_of(v);
  return j;
}

BB_ONCE_A_TYPE void put(Json& j, const FieldText& field, const Number& v) {
  put(j, std::string(field.name), v);
}
BB_ONCE_A_TYPE void put(Json& j, const FieldText& field, double v) { put(j, std::string(field.name), v); }
BB_ONCE_A_TYPE void put(Json& j, const FieldText& field, const std::optional<std::string>& v) {
  if (v) j[field.name] = *v;
}
template <class T>
BB_ONCE_A_TYPE void put(Json& j, const FieldText& field, const T& v) {
  j[field.name] = json_of(v);
}

template <Record T>
Json json_of(const T& v) {
  Json j = Json::object();
  for_each_field<T>([&](const FieldText& field, auto member) { put(j, field, std::invoke(member, v)); });
  return j;
}

/// Throws std::logic_error for a number that is not finite: the JSON library would write null
/// without a reason.
void require_finite(const Json& j) {
  if (j.is_number_float() && !std::isfinite(j.get<double>())) {
    throw std::logic_error("record: a non-finite number without a status");
  }
  if (j.is_structured()) {
    for (const Json& child : j) require_finite(child);
  }
}

// Bytes that are no UTF-8 (arguments, paths) are replaced: they must not cost the record.
template <class T>
std::string text_of(const T& record, int indent) {
  const Json j = json_of(record);
  require_finite(j);
  return j.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string to_json(const RunRecord& record) { return text_of(record, 1) + "\n"; }
std::string to_json(const TraceRow& row) { return text_of(row, -1); }

}  // namespace bb
