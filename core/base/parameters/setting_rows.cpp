#include "core/base/parameters/setting_rows.hpp"

#include <algorithm>
#include <stdexcept>

namespace bb {

namespace {

/// What a place holds of an object that is only read.
const void* held(const Place& place, const void* from) { return place(const_cast<void*>(from)); }

}  // namespace

void SettingRows::add_value(std::string_view name, Rule rule, std::string_view doc, Place place,
                            const ValueType& type, const void* blank) {
  const json fallback = type.give(held(place, blank));
  const bool unit_vector = rule.kind == Kind::direction;
  ParameterValue value = fallback.is_null() ? ParameterValue() : to_value(rule, fallback);
  const auto read = [place, &type, unit_vector](const json* given, void* out) {
    if (given == nullptr) return;
    void* to = place(out);
    type.take(*given, to);
    if (unit_vector) type.normalise(to);
  };
  add_by_hand({std::string(name), std::move(rule), std::move(value), std::string(doc)}, read,
              [place, &type](const void* from) { return type.give(held(place, from)); });
  settings_.back().place = std::move(place);
  settings_.back().type = &type;
}

void SettingRows::add_nested(std::string_view name, const SettingRows& settings, Place place,
                             std::string_view or_text) {
  Rule rule = settings.rule();
  rule.or_text = or_text;
  add_by_hand(
      {std::string(name), std::move(rule), no_default, ""},
      [&settings, place](const json* given, void* out) {
        settings.read_all(given ? *given : json::object(), place(out));
      },
      [&settings, place](const void* from) { return settings.write_all(held(place, from)); });
}

void SettingRows::add_list(std::string_view name, std::string_view doc, std::size_t least, std::size_t most,
                           const SettingRows& settings, Place place, const ListType& list) {
  Rule rule = settings.rule();
  rule.kind = Kind::objects;
  rule.min_size = least;
  rule.max_size = most;
  add_by_hand(
      {std::string(name), std::move(rule), no_default, std::string(doc)},
      [&settings, place, &list](const json* given, void* out) {
        for (std::size_t i = 0; given != nullptr && i < given->size(); ++i) {
          settings.read_all((*given)[i], list.append(place(out)));
        }
      },
      [&settings, place, &list](const void* from) {
        json out = json::array();
        const void* all = held(place, from);
        for (std::size_t i = 0; const void* one = list.at(all, i); ++i)
          out.push_back(settings.write_all(one));
        return out;
      });
}

void SettingRows::add_map(const std::vector<Parameter>& rows, const Place& place) {
  for (const Parameter& row : rows) {
    add_by_hand(
        row,
        [row, place](const json* given, void* out) {
          const json value = given ? *given : to_json(row.fallback);
          if (value.is_null()) return;
          (*static_cast<ParameterMap*>(place(out)))[row.name] = to_value(row.rule, value);
        },
        [name = row.name, place](const void* from) {
          const auto& map = *static_cast<const ParameterMap*>(held(place, from));
          return map.contains(name) ? to_json(map.at(name)) : json();
        });
  }
}

void SettingRows::add_by_hand(Parameter row, Read read, Write write) {
  settings_.push_back({std::move(row), std::move(read), std::move(write), nullptr, nullptr});
}

void SettingRows::read_all(const json& checked, void* out) const {
  for (const Setting& one : settings_) {
    if (!one.read) continue;
    const auto at = checked.find(one.row.name);
    one.read(at == checked.end() ? nullptr : &*at, out);
  }
}

const SettingRows::Setting& SettingRows::row_named(std::string_view name) const {
  const auto found = std::find_if(settings_.begin(), settings_.end(),
                                  [&](const Setting& one) { return one.row.name == name; });
  if (found == settings_.end()) throw std::logic_error("no row " + std::string(name));
  return *found;
}

void SettingRows::read_row(std::string_view name, const json* given, void* out) const {
  const Setting& one = row_named(name);
  if (one.read) one.read(given, out);
}

nlohmann::json SettingRows::write_row(std::string_view name, const void* from) const {
  const Setting& one = row_named(name);
  return one.write ? one.write(from) : json();
}

nlohmann::json SettingRows::write_all(const void* from) const {
  json out = json::object();
  for (const Setting& one : settings_) {
    json value = one.write ? one.write(from) : json();
    if (!value.is_null()) out[one.row.name] = std::move(value);
  }
  return out;
}

void SettingRows::check_all_numbers(const void* from, const Found& found) const {
  for (const Setting& one : settings_) {
    if (one.type == nullptr) continue;
    const std::optional<double> value = one.type->number(held(one.place, from));
    if (value && !in_range(one.row.rule, *value)) found(one.row.name, *value, allowed_text(one.row.rule));
  }
}

ParameterList SettingRows::rows() const {
  ParameterList out;
  out.doc = doc_;
  for (const Setting& one : settings_) out.rows.push_back(one.row);
  return out;
}

Rule SettingRows::rule() const {
  Rule out;
  out.kind = Kind::object;
  out.list = [this](const json&) { return rows(); };
  return out;
}

}  // namespace bb
