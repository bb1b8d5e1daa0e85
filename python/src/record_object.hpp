// Records as Python objects, by their lists of fields: the words of run.json and trace.jsonl.
#pragma once

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/record/run_record.hpp"
#include "core/base/record/trace_row.hpp"

namespace bb::python {

namespace nb = nanobind;

template <Record T>
nb::object object_of(const T& record);
template <class E>
requires std::is_enum_v<E> nb::object object_of(E word) { return nb::cast(std::string(to_string(word))); }
template <class T>
requires(std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) nb::object object_of(const T& value) {
  return nb::cast(value);
}
inline nb::object object_of(const Number& n) { return n.finite() ? nb::cast(n.value) : nb::none(); }
inline nb::object object_of(const std::optional<std::string>& text) {
  return text ? nb::cast(*text) : nb::none();
}
inline nb::object object_of(const SolverCounts& counts) {
  nb::dict out;
  for (const auto& [name, value] : counts.values) out[nb::cast(std::string(name))] = object_of(Number(value));
  return out;
}
inline nb::object object_of(const PhaseTimes& times) {
  nb::dict out;
  for (std::size_t i = 0; i < kPhases; ++i) {
    if (times.s[i] != 0) out[nb::cast(std::string(kPhaseNames[i]) + "_s")] = times.s[i];
  }
  return out;
}
template <class T>
nb::object object_of(const std::vector<T>& list) {
  nb::list out;
  for (const T& value : list) out.append(object_of(value));
  return out;
}

/// A number that is absent is None, and its reason stands beside it as NAME_status.
template <Record T>
nb::object object_of(const T& record) {
  nb::dict out;
  for_each_field<T>([&](const FieldText& field, auto member) {
    const auto& value = std::invoke(member, record);
    const nb::object name = nb::cast(std::string(field.name));
    out[name] = object_of(value);
    if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Number>) {
      if (!value.finite()) out[nb::cast(std::string(field.name) + "_status")] = value.status;
    }
  });
  return out;
}

}  // namespace bb::python
