#include "experiments/cli/sweep_spec.hpp"

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/math/error.hpp"
#include "experiments/config/parse.hpp"

namespace bb {
namespace {

using nlohmann::json;

json read_json(const std::string& path, std::string& text) {
  std::ifstream in(path);
  if (!in) throw ConfigError(path, "nothing readable", "a sweep file");
  std::ostringstream buffer;
  buffer << in.rdbuf();
  text = buffer.str();
  try {
    return json::parse(text);
  } catch (const json::parse_error& error) {
    throw ConfigError(path, error.what(), "valid JSON");
  }
}

// Indices of the cases of an axis with "reference": true.
std::vector<std::size_t> marked_cases(const json& axis) {
  std::vector<std::size_t> out;
  if (!axis.contains("cases")) return out;
  for (std::size_t k = 0; k < axis["cases"].size(); ++k) {
    const json& one = axis["cases"][k];
    const auto found = one.is_object() ? one.find("reference") : one.end();
    if (one.is_object() && found != one.end() && *found == json(true)) out.push_back(k);
  }
  return out;
}

// The case that differs from `index` in the axes with a mark only, where it is the marked one; the last axis
// runs fastest. Nothing without any mark.
std::optional<std::size_t> marked_reference(const json& axes, std::size_t index) {
  std::size_t out = 0, stride = 1;
  bool any = false;
  for (std::size_t a = axes.size(); a-- > 0;) {
    const json& axis = axes[a];
    const std::size_t n = axis.contains("pointer") ? axis["values"].size() : axis["cases"].size();
    const std::vector<std::size_t> marked = marked_cases(axis);
    any = any || !marked.empty();
    out += stride * (marked.empty() ? index % n : marked.front());
    index /= n;
    stride *= n;
  }
  return any ? std::optional(out) : std::nullopt;
}

class SpecReader {
 public:
  SpecReader(std::string path, const json& spec) : path_(std::move(path)), spec_(spec) {}

  // Every wrong key, type or value of the file itself.
  void validate() {
    if (!spec_.is_object()) fail("", spec_.type_name(), "an object");
    for (const auto& [key, value] : spec_.items()) {
      if (key != "schema" && key != "name" && key != "doc" && key != "base" && key != "set" &&
          key != "axes") {
        wrong("/" + key, "an unknown key", "schema, name, doc, base, set, axes");
      }
    }
    want("/schema", spec_.value("schema", json()) == json("barrierbench.sweep/1"),
         "\"barrierbench.sweep/1\"");
    want("/name", spec_.contains("name") && spec_["name"].is_string(), "a name");
    want("/base", spec_.contains("base") && spec_["base"].is_string(), "the path of a config");
    want("/set", !spec_.contains("set") || spec_["set"].is_object(), "an object of pointer: value");
    want("/axes", spec_.contains("axes") && spec_["axes"].is_array() && !spec_["axes"].empty(),
         "a list of axes");
    if (!violations_.empty()) throw ConfigError(violations_);
    for (std::size_t i = 0; i < spec_["axes"].size(); ++i) validate_axis(i);
    if (!violations_.empty()) throw ConfigError(violations_);
  }

 private:
  void validate_axis(std::size_t i) {
    const json& axis = spec_["axes"][i];
    const std::string where = "/axes/" + std::to_string(i);
    if (axis.is_object() && axis.contains("pointer")) {
      want(where + "/pointer", axis["pointer"].is_string(), "a JSON pointer");
      want(where + "/values", axis.contains("values") && axis["values"].is_array() && !axis["values"].empty(),
           "a list of values");
      return;
    }
    if (!axis.is_object() || !axis.contains("cases") || !axis["cases"].is_array() || axis["cases"].empty()) {
      return wrong(where, axis.dump(), "{pointer, values} or {cases: [{label, set}]}");
    }
    for (std::size_t k = 0; k < axis["cases"].size(); ++k) {
      const json& one = axis["cases"][k];
      const bool good = one.is_object() && one.contains("label") && one["label"].is_string() &&
                        one.contains("set") && one["set"].is_object() &&
                        (!one.contains("reference") || one["reference"].is_boolean());
      want(where + "/cases/" + std::to_string(k), good, "{label, set} and perhaps reference: true");
    }
    if (marked_cases(axis).size() > 1)
      wrong(where, "more than one reference", "one case with reference: true");
  }
  void want(const std::string& pointer, bool good, const char* allowed) {
    if (good) return;
    const json::json_pointer at(pointer);
    wrong(pointer, spec_.contains(at) ? spec_[at].dump() : "nothing", allowed);
  }
  void wrong(const std::string& pointer, const std::string& found, const std::string& allowed) {
    violations_.push_back({path_ + "#" + pointer, found, allowed});
  }
  [[noreturn]] void fail(const std::string& pointer, const std::string& found, const std::string& allowed) {
    throw ConfigError(path_ + "#" + pointer, found, allowed);
  }

  std::string path_;
  const json& spec_;
  std::vector<Violation> violations_;
};

void append_set(const json& set, std::vector<std::string>& overrides) {
  for (const auto& [pointer, value] : set.items()) overrides.push_back(pointer + "=" + value.dump());
}

std::string value_label(const std::string& pointer, const json& value) {
  const std::string key = pointer.substr(pointer.rfind('/') + 1);
  return key + "=" + (value.is_string() ? value.get<std::string>() : value.dump());
}

// The cases so far, each extended by every entry of one axis.
std::vector<SweepCase> extend(const std::vector<SweepCase>& cases, const json& axis) {
  std::vector<SweepCase> out;
  for (const SweepCase& base : cases) {
    const auto add = [&](const std::string& label, const json& set) {
      SweepCase next = base;
      next.label += (next.label.empty() ? "" : " ") + label;
      append_set(set, next.set);
      out.push_back(std::move(next));
    };
    if (axis.contains("pointer")) {
      const auto pointer = axis["pointer"].get<std::string>();
      for (const json& value : axis["values"]) add(value_label(pointer, value), json{{pointer, value}});
    } else {
      for (const json& one : axis["cases"]) add(one["label"].get<std::string>(), one["set"]);
    }
  }
  return out;
}

}  // namespace

SweepSpec load_sweep(const std::string& path, const std::vector<std::string>& overrides) {
  SweepSpec out;
  const json spec = read_json(path, out.text);
  SpecReader(path, spec).validate();
  out.name = spec["name"].get<std::string>();

  SweepCase first;
  if (spec.contains("set")) append_set(spec["set"], first.set);
  out.cases = {first};
  for (const json& axis : spec["axes"]) out.cases = extend(out.cases, axis);
  for (std::size_t i = 0; i < out.cases.size(); ++i) {
    out.cases[i].reference = marked_reference(spec["axes"], i);
  }

  const auto base = std::filesystem::path(path).parent_path() / spec["base"].get<std::string>();
  std::vector<Violation> violations;
  for (SweepCase& one : out.cases) {
    one.set.insert(one.set.end(), overrides.begin(), overrides.end());
    try {
      one.config = load_config(base.string(), one.set);
    } catch (const ConfigError& error) {
      for (Violation v : error.violations()) {
        v.where = path + " [" + one.label + "] " + v.where;
        violations.push_back(std::move(v));
      }
    }
  }
  if (!violations.empty()) throw ConfigError(violations);
  return out;
}

}  // namespace bb
