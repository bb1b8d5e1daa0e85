#include "experiments/config/config_family.hpp"

#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>

#include "core/base/input/read_file.hpp"
#include "core/base/record/places.hpp"
#include "core/base/record/provenance.hpp"
#include "core/math/error.hpp"
#include "experiments/config/document.hpp"
#include "experiments/config/formula_shapes.hpp"
#include "experiments/config/parse.hpp"
#include "experiments/config/presets.hpp"
#include "experiments/config/reader.hpp"
#include "experiments/config/run_sections.hpp"
#include "experiments/config/sections.hpp"

namespace bb {
namespace {

using nlohmann::json;

constexpr std::size_t most_checked = 4096;  // sections that are kept, some kilobytes each

/// The rows of a config. Each is one of these or stands in for_each_section. Errors: logic_error: one that is not.
ParameterList known_rows() {
  ParameterList rows = settings_of<RunConfig>().rows();
  std::set<std::string> known = {"schema", "name", "doc", "extends", "scene"};
  for_each_section([&](const char* name, auto) { known.insert(name); });
  for (const Parameter& row : rows.rows) {
    if (!known.contains(row.name)) throw std::logic_error("for_each_section lacks " + row.name);
  }
  return rows;
}

/// Made once: a list of rows is copied whenever it is requested.
const std::vector<Parameter>& config_rows() {
  static const ParameterList rows = known_rows();
  return rows.rows;
}

/// The key that an override acts below; empty where it is none ("/pointer=value").
std::string_view section_of(std::string_view text) {
  const std::size_t end = text.find_first_of("/=", 1);
  if (text.empty() || text[0] != '/' || end == std::string_view::npos) return {};
  return text.substr(1, end - 1);
}

}  // namespace

ConfigFamily::ConfigFamily(std::string path)
    : path_(std::move(path)),
      folder_(std::filesystem::path(path_).parent_path().string()),
      text_(read_input_file(path_, config_file)) {
  if (folder_.empty()) folder_ = ".";
}

const RunConfig& ConfigFamily::read(std::span<const std::string> overrides) {
  if (!read_sections(overrides)) {
    known_ = false;
    scene_is_written_ = false;
    config_ = parse_config(text_, path_, folder_, overrides);
  }
  return config_;
}

/// The document below all overrides but those of the method, whose settings lie under the others.
bool ConfigFamily::make_base(std::span<const std::string> overrides) {
  std::vector<std::string> of_method;
  std::string joined;
  for (const std::string& text : overrides) {
    if (section_of(text) != "method") continue;
    of_method.push_back(text);
    joined.append(text).push_back('\0');
  }
  if (known_ && joined == method_) return true;
  known_ = false;
  checked_.clear();
  std::vector<Violation> violations;
  base_ = make_document(text_, path_, folder_, of_method, violations);
  if (!violations.empty() || !base_.is_object()) return false;
  for (const auto& item : base_.items()) {
    if (find_named(config_rows(), item.key()) == nullptr) return false;
  }
  method_ = joined;
  document_ = json::object();
  return true;
}

/// The overrides of each row into given_. False for one of no row, or of `extends`, which decides what lies
/// under all of them.
bool ConfigFamily::sort_overrides(std::span<const std::string> overrides) {
  const std::vector<Parameter>& rows = config_rows();
  given_.resize(rows.size());
  for (std::string& joined : given_) joined.clear();
  for (const std::string& text : overrides) {
    const std::string_view name = section_of(text);
    const Parameter* row = find_named(rows, name);
    if (row == nullptr || name == "extends") return false;
    if (name == "method") continue;  // base_ has it
    given_[static_cast<std::size_t>(row - rows.data())].append(text).push_back('\0');
  }
  return true;
}

bool ConfigFamily::read_sections(std::span<const std::string> overrides) {
  if (!make_base(overrides) || !sort_overrides(overrides)) return false;
  const std::vector<Parameter>& rows = config_rows();
  overrides_.resize(rows.size());
  std::vector<std::string_view> anew;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (known_ && overrides_[r] == given_[r]) continue;
    overrides_[r] = given_[r];
    if (!read_section(rows[r], overrides_[r], overrides)) return false;
    anew.push_back(rows[r].name);
  }
  const auto is_anew = [&](const char* name) {
    return std::find(anew.begin(), anew.end(), name) != anew.end();
  };

  std::vector<Violation> violations;
  const Reader reader{path_, violations};
  const bool all = !known_ || is_anew("scene") || is_anew("device");
  if (all) {
    scene_is_written_ = false;
    blank_ = RunConfig{};
    scene_ = begin_config(document_, reader, blank_);
    read_ = blank_;
    settings_of<RunConfig>().read(document_, read_);
  }
  for_each_section([&](const char* name, auto member) {
    if (all || !is_anew(name)) return;
    read_.*member = blank_.*member;
    settings_of<RunConfig>().read_one(name, document_.contains(name) ? &document_[name] : nullptr, read_);
  });
  if (read_.scene.name == "bodies") require_scales(document_, reader);
  config_ = read_;
  finish_config(document_, scene_, reader, config_);
  known_ = true;
  return violations.empty();
}

bool ConfigFamily::read_section(const Parameter& row, const std::string& own,
                                std::span<const std::string> overrides) {
  const std::string& name = row.name;
  const auto [kept, is_new] = checked_.try_emplace(name + "\n" + own);
  json& value = kept->second;
  if (is_new) {
    json alone = json::object();
    if (base_.contains(name)) alone[name] = base_[name];
    std::vector<Violation> violations;
    for (const std::string& text : overrides) {
      if (!own.empty() && section_of(text) == name) apply_override(alone, text, folder_, violations);
    }
    if (alone.contains(name)) {
      value = std::move(alone[name]);
      const std::string where = path_ + "#/" + name;
      check_value(value, row.rule, where, violations);
      if (violations.empty() && (name == "formulation" || name == "strain_limit"))
        name_formula(value, where, violations);
      if (violations.empty() && name == "formulation") expand_preset(value, path_, violations);
    } else if (row.rule.required) {
      violations.push_back({name, "nothing", "a value"});
    }
    if (!violations.empty()) {
      checked_.erase(kept);
      return false;
    }
  }
  value.is_null() ? static_cast<void>(document_.erase(name)) : static_cast<void>(document_[name] = value);
  if (checked_.size() > most_checked) checked_.clear();
  return true;
}

void ConfigFamily::write_section(const std::string& name) {
  const json value = resolved_section(name, config_);
  Written& out = texts_[name];
  out = {};
  if (value.is_null()) return;
  const std::string text = value.dump();
  const bool has_places = text.find("\"sha256\"") != std::string::npos;
  out.member = json(name).dump() + ":" + (has_places ? without_places(value).dump() : text);
  if (has_places) out.places = sha256_hex(text);
  if (name == "scene") scene_hash_ = sha256_hex(text);
}

ConfigFamily::Identity ConfigFamily::identity() {
  const bool first = texts_.empty();
  if (first) {
    for (const Parameter& row : config_rows()) texts_[row.name];
    write_section("schema");
  }
  if (!scene_is_written_) write_section("scene");
  for_each_section([&](const char* name, auto member) {
    const bool of_scene = !scene_is_written_ && std::string_view(name) == "hessian";
    if (!first && !of_scene && same(written_.*member, config_.*member)) return;
    write_section(name);
    written_.*member = config_.*member;
  });
  scene_is_written_ = true;
  std::string text, others;
  for (const auto& [name, section] : texts_) {  // in the order of a document
    if (name == "threads") {
      others += section.member;
    } else if (!section.member.empty()) {
      text += (text.empty() ? "{" : ",") + section.member;
    }
    others += section.places;
  }
  text += '}';
  Identity out{sha256_hex(text), {}, scene_hash_};
  out.document = out.config_id + " " + others;
  return out;
}

}  // namespace bb
