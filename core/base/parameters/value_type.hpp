// How a value of a C++ type is taken from JSON and given as JSON: a table a type, whatever struct keeps the value.
#pragma once

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "core/math/direction.hpp"
#include "core/math/types.hpp"

namespace bb {

/// From a checked value. The words of an enumeration are those of its words_of, which is found beside it.
template <class T>
void take(const nlohmann::json& value, T& out) {
  if constexpr (std::is_enum_v<T>) {
    const auto* given = value.template get_ptr<const std::string*>();
    for (const auto& [each, word] : words_of(T())) {
      if (given != nullptr && *given == word) out = each;
    }
  } else if constexpr (std::is_same_v<T, Vec3d>) {
    for (int i = 0; i < 3; ++i) out[i] = value[static_cast<std::size_t>(i)].template get<double>();
  } else if constexpr (requires {
                         out.emplace();
                         out.has_value();
                       }) {
    take(value, out.emplace());
  } else if constexpr (std::is_same_v<T, std::array<Vec3d, 2>>) {
    for (std::size_t i = 0; i < 2; ++i) take(value[i], out[i]);
  } else if constexpr (requires {
                         out.clear();
                         out.front();
                       } &&
                       !std::is_same_v<T, std::string>) {
    out.clear();
    for (const nlohmann::json& one : value) take(one, out.emplace_back());
  } else {
    out = value.template get<T>();
  }
}

/// What stands in a resolved config; null where nothing does: an optional without value, an empty text
/// or list, infinity.
template <class T>
nlohmann::json give(const T& value) {
  using nlohmann::json;
  if constexpr (std::is_enum_v<T>) {
    for (const auto& [each, word] : words_of(T())) {
      if (value == each) return word;
    }
    return nullptr;
  } else if constexpr (std::is_same_v<T, Vec3d>) {
    return json::array({value[0], value[1], value[2]});
  } else if constexpr (requires { value.has_value(); }) {
    return value.has_value() ? give(*value) : json();
  } else if constexpr (std::is_same_v<T, std::array<Vec3d, 2>>) {
    return json::array({give(value[0]), give(value[1])});
  } else if constexpr (std::is_same_v<T, double>) {
    return std::isfinite(value) ? json(value) : json();
  } else if constexpr (std::is_same_v<T, std::string>) {
    return value.empty() ? json() : json(value);
  } else if constexpr (requires { value.front(); }) {
    json out;
    for (const auto& one : value) out.push_back(give(one));
    return out;
  } else {
    return value;
  }
}

/// Of a double or an optional one.
template <class T>
std::optional<double> number_of(const T& value) {
  if constexpr (std::is_same_v<T, double> || std::is_same_v<T, std::optional<double>>) return value;
  return std::nullopt;
}

/// To length 1, what is a vector or an optional one that has a value. What was normalised once is left as it is, so that a
/// resolved config reads back bit for bit.
template <class T>
void normalise(T& value) {
  if constexpr (std::is_same_v<T, Vec3d>) {
    value = of_usual_size(value);
    const double length = value.norm();
    if (!(std::abs(length - 1) < 1e-14)) value /= length;
  } else if constexpr (std::is_same_v<T, std::optional<Vec3d>>) {
    normalise(*value);
  }
}

/// The same of a type that is known at run time only; `value` is one of it.
struct ValueType {
  void (*take)(const nlohmann::json& given, void* value);
  nlohmann::json (*give)(const void* value);
  std::optional<double> (*number)(const void* value);
  void (*normalise)(void* value);
};

template <class T>
inline constexpr ValueType value_type = {
    [](const nlohmann::json& given, void* value) { take(given, *static_cast<T*>(value)); },
    [](const void* value) { return give(*static_cast<const T*>(value)); },
    [](const void* value) { return number_of(*static_cast<const T*>(value)); },
    [](void* value) { normalise(*static_cast<T*>(value)); }};

}  // namespace bb
