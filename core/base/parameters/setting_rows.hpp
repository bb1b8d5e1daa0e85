// The settings of a struct that is known by its address only: what settings.hpp does for every struct, compiled once.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/parameters/check.hpp"
#include "core/base/parameters/value_type.hpp"

namespace bb {

/// From a struct to a part of it.
using Place = std::function<void*(void*)>;

/// A vector of structs that is known by its address only.
struct ListType {
  void* (*append)(void* list);                         // one more, as the default constructor leaves it
  const void* (*at)(const void* list, std::size_t i);  // null behind the last
};

template <class M>
inline constexpr ListType list_type = {
    [](void* list) -> void* { return &static_cast<std::vector<M>*>(list)->emplace_back(); },
    [](const void* list, std::size_t i) -> const void* {
      const auto& all = *static_cast<const std::vector<M>*>(list);
      return i < all.size() ? &all[i] : nullptr;
    }};

class SettingRows {
 public:
  using json = nlohmann::json;
  using Read = std::function<void(const json*, void*)>;
  using Write = std::function<json(const void*)>;
  using Found = std::function<void(const std::string& name, double value, const std::string& allowed)>;

  ParameterList rows() const;
  Rule rule() const;

 protected:
  explicit SettingRows(std::string doc) : doc_(std::move(doc)) {}
  ~SettingRows() = default;
  SettingRows(const SettingRows&) = default;
  SettingRows(SettingRows&&) = default;
  SettingRows& operator=(const SettingRows&) = default;
  SettingRows& operator=(SettingRows&&) = default;

  /// A value of `type` at `place`; its default is what `blank` holds there.
  void add_value(std::string_view name, Rule rule, std::string_view doc, Place place, const ValueType& type,
                 const void* blank);
  /// `settings` outlives this list.
  void add_nested(std::string_view name, const SettingRows& settings, Place place, std::string_view or_text);
  void add_list(std::string_view name, std::string_view doc, std::size_t least, std::size_t most,
                const SettingRows& settings, Place place, const ListType& list);
  /// `place` is that of a ParameterMap.
  void add_map(const std::vector<Parameter>& rows, const Place& place);
  void add_by_hand(Parameter row, Read read, Write write);

  void read_all(const json& checked, void* out) const;
  json write_all(const void* from) const;
  /// What these do of one row. Precondition: there is a row of that name.
  void read_row(std::string_view name, const json* given, void* out) const;
  json write_row(std::string_view name, const void* from) const;
  void check_all_numbers(const void* from, const Found& found) const;

 private:
  struct Setting {
    Parameter row;
    Read read;
    Write write;
    Place place;  // of a value, with its type
    const ValueType* type = nullptr;
  };

  const Setting& row_named(std::string_view name) const;

  std::string doc_;
  std::vector<Setting> settings_;
};

}  // namespace bb
