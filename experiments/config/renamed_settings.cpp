#include "experiments/config/renamed_settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "experiments/config/enum_words.hpp"

namespace bb {
namespace {

using nlohmann::json;

struct RenamedSetting {
  std::string section, present, earlier;
  std::vector<std::string>
      words;  // the earlier value is the number of one of them, from 0; empty: it is the present one

  std::string present_place() const { return "/" + section + "/" + present; }
  std::string earlier_place() const { return "/" + section + "/" + earlier; }
};

const std::array<RenamedSetting, 2>& renamed_settings() {
  static const std::array<RenamedSetting, 2> all = {
      RenamedSetting{"contact", "min_gap_fraction", "ccd_park", {}},
      RenamedSetting{"diagnose", "estimator", "tier", one_of<Estimator>().words()}};
  return all;
}

/// A value that is not the number of a word stays: the check of the config names it.
json to_present(const RenamedSetting& one, json value) {
  if (!value.is_number_unsigned() || value.get<std::size_t>() >= one.words.size()) return value;
  return one.words[value.get<std::size_t>()];
}

json to_earlier(const RenamedSetting& one, const json& value) {
  const auto word = std::find(one.words.begin(), one.words.end(), value);
  return word == one.words.end() ? value : json(word - one.words.begin());
}

void move_key(json& object, const std::string& from, const std::string& to, json value) {
  object.erase(from);
  object[to] = std::move(value);
}

}  // namespace

std::optional<Violation> use_present_names(json& document, const std::string& where) {
  for (const RenamedSetting& one : renamed_settings()) {
    if (!document.is_object() || !document.contains(one.section)) continue;
    json& section = document[one.section];
    if (!section.is_object() || !section.contains(one.earlier)) continue;
    if (section.contains(one.present)) {
      return Violation{where + "/" + one.section, one.earlier + " and " + one.present,
                       fmt::format("one of them: {} is the earlier name of {}", one.earlier, one.present)};
    }
    move_key(section, one.earlier, one.present, to_present(one, section[one.earlier]));
  }
  return {};
}

std::string present_pointer(const std::string& pointer, json& value) {
  for (const RenamedSetting& one : renamed_settings()) {
    if (pointer != one.earlier_place()) continue;
    value = to_present(one, std::move(value));
    return one.present_place();
  }
  return pointer;
}

void use_recorded_names(const std::string& section, json& settings) {
  for (const RenamedSetting& one : renamed_settings()) {
    if (one.section != section || !settings.is_object() || !settings.contains(one.present)) continue;
    move_key(settings, one.present, one.earlier, to_earlier(one, settings[one.present]));
  }
}

void note_earlier_names(const std::string& config_text, std::span<const std::string> overrides) {
  const json config = json::parse(config_text, nullptr, false);
  for (const RenamedSetting& one : renamed_settings()) {
    const auto sets = [&](const std::string& text) { return text.starts_with(one.earlier_place() + "="); };
    const bool in_file = config.is_object() && config.contains(json::json_pointer(one.earlier_place()));
    if (!in_file && std::none_of(overrides.begin(), overrides.end(), sets)) continue;
    const std::string line = fmt::format("note: {} is now {}\n", one.earlier_place(), one.present_place());
    std::fputs(line.c_str(), stderr);
  }
}

void add_earlier_names(nlohmann::ordered_json& schema) {
  for (const RenamedSetting& one : renamed_settings()) {
    nlohmann::ordered_json& section = schema["properties"][one.section];
    nlohmann::ordered_json earlier = section["properties"][one.present];
    earlier["description"] = fmt::format("The earlier name of {}, which records have.", one.present);
    if (!one.words.empty()) {
      earlier.erase("enum");
      earlier["type"] = "integer";
      earlier["minimum"] = 0;
      earlier["maximum"] = one.words.size() - 1;
      if (earlier.contains("default")) earlier["default"] = to_earlier(one, json(earlier["default"]));
    }
    section["properties"][one.earlier] = earlier;
    section["not"] = {{"required", {one.earlier, one.present}}};
  }
}

}  // namespace bb
