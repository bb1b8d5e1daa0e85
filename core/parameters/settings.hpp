// The settings of a struct: the row of each (core/parameters) with its way into the struct and out of it.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/math/types.hpp"
#include "core/parameters/check.hpp"

namespace bb {

/// From a checked value. The words of an enumeration are those of its words_of, which is found beside it.
template <class T>
void take(const nlohmann::json& value, T& out) {
  if constexpr (std::is_enum_v<T>) {
    for (const auto& [each, word] : words_of(T())) {
      if (value == word) out = each;
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

template <class S>
class Settings {
 public:
  using json = nlohmann::json;

  explicit Settings(std::string doc) : doc_(std::move(doc)) {}

  /// A setting kept in what `access` names: a pointer to member, or a function from (const) S& to a
  /// reference. Its default is what S() holds there.
  template <class Access>
  void add(std::string name, Rule rule, std::string doc, Access access) {
    const json fallback = give(std::invoke(access, std::as_const(blank_)));
    const bool unit_vector = rule.kind == Kind::direction;
    ParameterValue value = fallback.is_null() ? ParameterValue() : to_value(rule, fallback);
    std::function<std::optional<double>(const S&)> number;
    if constexpr (is_number<decltype(std::invoke(access, std::as_const(blank_)))>) {
      number = [access](const S& from) { return std::optional<double>(std::invoke(access, from)); };
    }
    const auto read = [access, unit_vector](const json* given, S& out) {
      if (given == nullptr) return;
      auto& held = std::invoke(access, out);
      take(*given, held);
      if (unit_vector) normalise(held);
    };
    add_row({std::move(name), std::move(rule), std::move(value), std::move(doc)}, read,
            [access](const S& from) { return give(std::invoke(access, from)); });
    settings_.back().number = std::move(number);
  }

  /// An object of settings of its own. `settings` outlives this list. `or_text` says what a string in
  /// its place names.
  template <class M, class Access>
  void nest(std::string name, const Settings<M>& settings, Access access, std::string or_text = "") {
    Rule rule = settings.rule();
    rule.or_text = std::move(or_text);
    add_row(
        {std::move(name), std::move(rule), no_default, ""},
        [&settings, access](const json* given, S& out) {
          settings.read(given ? *given : json::object(), std::invoke(access, out));
        },
        [&settings, access](const S& from) { return settings.write(std::invoke(access, from)); });
  }

  /// A list of such objects, kept in a vector of M.
  template <class M, class Access>
  void nest_all(std::string name, std::string doc, std::size_t most, const Settings<M>& settings,
                Access access) {
    Rule rule = settings.rule();
    rule.kind = Kind::objects;
    rule.max_size = most;
    add_row(
        {std::move(name), std::move(rule), no_default, std::move(doc)},
        [&settings, access](const json* given, S& out) {
          for (std::size_t i = 0; given != nullptr && i < given->size(); ++i) {
            settings.read((*given)[i], std::invoke(access, out).emplace_back());
          }
        },
        [&settings, access](const S& from) {
          json out = json::array();
          for (const auto& one : std::invoke(access, from)) out.push_back(settings.write(one));
          return out;
        });
  }

  /// Rows that are kept in a ParameterMap, each with its default.
  template <class Access>
  void own(const std::vector<Parameter>& rows, Access access) {
    for (const Parameter& row : rows) {
      add_row(
          row,
          [row, access](const json* given, S& out) {
            const json value = given ? *given : to_json(row.fallback);
            if (!value.is_null()) std::invoke(access, out)[row.name] = to_value(row.rule, value);
          },
          [name = row.name, access](const S& from) {
            const ParameterMap& held = std::invoke(access, from);
            return held.contains(name) ? to_json(held.at(name)) : json();
          });
    }
  }

  /// A row by hand. read gets null where nothing is given, write answers null where nothing is to stand;
  /// without them the row is only checked.
  void add_row(Parameter row, std::function<void(const json*, S&)> read = nullptr,
               std::function<json(const S&)> write = nullptr) {
    settings_.push_back({std::move(row), std::move(read), std::move(write), nullptr});
  }

  /// Settings that are not given stay as they stand in `out`, except in nested maps of parameters.
  void read(const json& checked, S& out) const {
    for (const Setting& one : settings_) {
      if (!one.read) continue;
      const auto at = checked.find(one.row.name);
      one.read(at == checked.end() ? nullptr : &*at, out);
    }
  }
  json write(const S& from) const {
    json out = json::object();
    for (const Setting& one : settings_) {
      json value = one.write ? one.write(from) : json();
      if (!value.is_null()) out[one.row.name] = std::move(value);
    }
    return out;
  }

  /// Calls found(name, value, what is allowed) for every number of `from` that its rule does not allow. Values that no JSON
  /// gave: a scene made in C++.
  template <class Found>
  void check_numbers(const S& from, const Found& found) const {
    for (const Setting& one : settings_) {
      const std::optional<double> value = one.number ? one.number(from) : std::nullopt;
      if (value && !in_range(one.row.rule, *value)) found(one.row.name, *value, allowed_text(one.row.rule));
    }
  }

  ParameterList rows() const {
    ParameterList out;
    out.doc = doc_;
    for (const Setting& one : settings_) out.rows.push_back(one.row);
    return out;
  }
  Rule rule() const {
    Rule out;
    out.kind = Kind::object;
    out.list = [this](const json&) { return rows(); };
    return out;
  }

 private:
  struct Setting {
    Parameter row;
    std::function<void(const json*, S&)> read;
    std::function<json(const S&)> write;
    std::function<std::optional<double>(const S&)> number;  // of a member that is one
  };

  template <class T>
  static constexpr bool is_number = std::is_same_v<std::remove_cvref_t<T>, double> ||
                                    std::is_same_v<std::remove_cvref_t<T>, std::optional<double>>;

  /// What was normalised once is left as it is, so that a resolved config reads back bit for bit.
  static void normalise(Vec3d& axis) {
    const double length = axis.norm();
    if (!(std::abs(length - 1) < 1e-14)) axis /= length;
  }
  static void normalise(std::optional<Vec3d>& axis) { normalise(*axis); }
  template <class T>
  static void normalise(T&) {}

  std::string doc_;
  S blank_;
  std::vector<Setting> settings_;
};

/// The list of a struct, made by the file that declares it; settings_of keeps it.
template <class S>
Settings<S> list_of();
template <class S>
const Settings<S>& settings_of() {
  static const Settings<S> list = list_of<S>();
  return list;
}

}  // namespace bb
