// The settings of a struct: the row of each (core/base/parameters) with its way into the struct and out of it.
#pragma once

#include <type_traits>

#include "core/base/parameters/setting_rows.hpp"

namespace bb {

template <class S>
class Settings : public SettingRows {
 public:
  explicit Settings(std::string doc) : SettingRows(std::move(doc)) {}

  /// A setting kept in what `access` names: a pointer to member, or a function from S& to a reference. Its default is
  /// what S() holds there.
  template <class Access>
  void add(std::string_view name, Rule rule, std::string_view doc, Access access) {
    using T = std::remove_cvref_t<decltype(part(access, blank_))>;
    add_value(name, std::move(rule), doc, place_of(access), value_type<T>, &blank_);
  }

  /// An object of settings of its own. `settings` outlives this list. `or_text` says what a string in
  /// its place names.
  template <class M, class Access>
  void nest(std::string_view name, const Settings<M>& settings, Access access,
            std::string_view or_text = "") {
    static_assert(std::is_same_v<std::remove_cvref_t<decltype(part(access, blank_))>, M>);
    add_nested(name, settings, place_of(access), or_text);
  }

  /// A list of such objects, of sizes that are given, kept in a vector of M. most 0: no bound.
  template <class M, class Access>
  void nest_all(std::string_view name, std::string_view doc, std::size_t least, std::size_t most,
                const Settings<M>& settings, Access access) {
    static_assert(std::is_same_v<std::remove_cvref_t<decltype(part(access, blank_))>, std::vector<M>>);
    add_list(name, doc, least, most, settings, place_of(access), list_type<M>);
  }

  /// Rows that are kept in a ParameterMap, each with its default.
  template <class Access>
  void own(const std::vector<Parameter>& rows, Access access) {
    static_assert(std::is_same_v<std::remove_cvref_t<decltype(part(access, blank_))>, ParameterMap>);
    add_map(rows, place_of(access));
  }

  /// A row by hand. read gets null where nothing is given, write answers null where nothing is to stand;
  /// without them the row is only checked.
  void add_row(Parameter row, std::function<void(const json*, S&)> read = nullptr,
               std::function<json(const S&)> write = nullptr) {
    Read into;
    Write out_of;
    if (read) {
      into = [read = std::move(read)](const json* given, void* out) { read(given, *static_cast<S*>(out)); };
    }
    if (write) {
      out_of = [write = std::move(write)](const void* from) { return write(*static_cast<const S*>(from)); };
    }
    add_by_hand(std::move(row), std::move(into), std::move(out_of));
  }

  /// Settings that are not given stay as they stand in `out`, except in nested maps of parameters.
  void read(const json& checked, S& out) const { read_all(checked, &out); }
  json write(const S& from) const { return write_all(&from); }
  /// The same of one row, which there is; null: nothing is given, nothing is written.
  void read_one(std::string_view name, const json* given, S& out) const { read_row(name, given, &out); }
  json write_one(std::string_view name, const S& from) const { return write_row(name, &from); }

  /// Calls found(name, value, what is allowed) for every number of `from` that its rule does not allow. Values that no JSON
  /// gave: a scene made in C++.
  void check_numbers(const S& from, const Found& found) const { check_all_numbers(&from, found); }

 private:
  template <class Access>
  static auto& part(const Access& access, S& of) {
    if constexpr (std::is_member_object_pointer_v<Access>) {
      return of.*access;
    } else {
      return access(of);
    }
  }
  /// A function without state is made once more where it is called, so that all of them are of one type.
  template <class Access>
  static Place place_of(const Access& access) {
    if constexpr (std::is_empty_v<Access>) {
      return static_cast<void* (*)(void*)>(
          [](void* of) -> void* { return &part(Access(), *static_cast<S*>(of)); });
    } else {
      return [access](void* of) -> void* { return &part(access, *static_cast<S*>(of)); };
    }
  }

  S blank_;
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
