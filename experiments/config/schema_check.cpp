#include "experiments/config/schema_check.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validation_results.hpp>
#include <valijson/validator.hpp>

#include "barriers/named_entries.hpp"
#include "core/input/names.hpp"

namespace bb {
namespace {

using nlohmann::json;
using Path = std::vector<std::string>;  // tokens of a JSON pointer

std::string pointer_text(const Path& path) {
  json::json_pointer pointer;
  for (const std::string& token : path) pointer /= token;
  return pointer.to_string();
}

/// The validator writes "<root>", "[key]" and "[3]".
Path to_path(const std::vector<std::string>& context) {
  Path path;
  for (const std::string& part : context) {
    if (part.size() > 2 && part.front() == '[') path.push_back(part.substr(1, part.size() - 2));
  }
  return path;
}

const json& follow_ref(const json& root, const json& node) {
  if (!node.is_object() || !node.contains("$ref")) return node;
  return root.at(json::json_pointer(node["$ref"].get<std::string>().substr(1)));  // "#/definitions/x"
}

/// The part of the schema that rules the value at `path`; null where the schema leaves it open.
json schema_at(const json& root, const Path& path) {
  json node = root;
  for (const std::string& token : path) {
    if (node.contains("properties") && node["properties"].contains(token)) {
      node = json(follow_ref(root, node["properties"][token]));
    } else if (node.contains("items")) {
      node = json(follow_ref(root, node["items"]));
    } else {
      return {};
    }
  }
  return node;
}

std::vector<std::string> keys_of(const json& object) {
  std::vector<std::string> names;
  for (const auto& item : object.items()) names.push_back(item.key());
  return names;
}

std::string range_text(const json& node) {
  std::string out;
  const auto add = [&](const char* key, const char* sign) {
    if (node.contains(key)) out += fmt::format("{} {} {}", out.empty() ? "" : " and", sign, node[key].dump());
  };
  add("exclusiveMinimum", ">");
  add("minimum", ">=");
  add("exclusiveMaximum", "<");
  add("maximum", "<=");
  return out;
}

std::string type_text(const json& type) {
  if (type.is_array()) {
    std::string out;
    for (const json& one : type) out += (out.empty() ? "" : " or ") + type_text(one);
    return out;
  }
  const std::string name = type.get<std::string>();
  return (name == "integer" || name == "array" || name == "object" ? "an " : "a ") + name;
}

/// "a number > 0 (s)", "one of a, b", "an array of 3", ...
std::string allowed_text(const json& node, const json& found) {
  if (node.contains("const")) return node["const"].dump();
  if (node.contains("enum")) {
    std::vector<std::string> names;
    for (const json& one : node["enum"])
      names.push_back(one.is_string() ? one.get<std::string>() : one.dump());
    const std::string nearest = found.is_string() ? nearest_name(found.get<std::string>(), names) : "";
    return fmt::format("one of {}{}", fmt::join(names, ", "),
                       nearest.empty() ? "" : " (did you mean " + nearest + "?)");
  }
  if (!node.contains("type")) return node.value("description", "another value");
  std::string out = type_text(node["type"]) + range_text(node);
  if (node.contains("minItems")) {
    out += node.value("maxItems", json()) == node["minItems"]
               ? fmt::format(" of {} items", node["minItems"].dump())
               : fmt::format(" of at least {} items", node["minItems"].dump());
  }
  if (node.contains("maxItems") && !node.contains("minItems")) {
    out += fmt::format(" of at most {} items", node["maxItems"].dump());
  }
  if (node.contains("minLength")) out += " that is not empty";
  if (node.contains("maxLength")) out += fmt::format(" of at most {} bytes", node["maxLength"].dump());
  if (node.contains("unit") && node["unit"] != "1")
    out += fmt::format(" ({})", node["unit"].get<std::string>());
  return out;
}

class Collector {
 public:
  Collector(json& document, json schema, const std::string& source, std::vector<Violation>& violations)
      : document_(document), source_(source), violations_(violations), schema_(std::move(schema)) {}

  void take(const valijson::ValidationResults::Error& error) {
    const Path path = to_path(error.context);
    if (error.description.starts_with("Failed to validate")) return take_choice(path);
    if (error.description.starts_with("Target should not")) return;  // within a choice
    if (error.description.starts_with("Object contains a property")) return take_unknown_keys(path);
    if (error.description.starts_with("Missing required property '")) {
      const std::size_t begin = error.description.find('\'') + 1;
      Path child = path;
      child.push_back(error.description.substr(begin, error.description.find('\'', begin) - begin));
      const json required = schema_at(schema_, path).value("required", json::array());
      if (std::find(required.begin(), required.end(), json(child.back())) == required.end())
        return;  // of a choice
      return report(child, "nothing", allowed_text(schema_at(schema_, child), json()));
    }
    const json& found = document_.at(json::json_pointer(pointer_text(path)));
    report(path, found.dump(), allowed_text(schema_at(schema_, path), found));
    wrong_.push_back(path);
  }

  void remove_wrong() {
    for (Path path : wrong_) {
      if (path.empty()) {
        document_ = json::object();
        return;
      }
      // Numbers of a vector stand or fall together.
      while (path.size() > 1 && holder(path) && holder(path)->is_array()) path.pop_back();
      if (json* object = holder(path); object && object->is_object()) object->erase(path.back());
    }
  }

 private:
  json* holder(Path path) {
    path.pop_back();
    const json::json_pointer pointer(pointer_text(path));
    return document_.contains(pointer) ? &document_[pointer] : nullptr;
  }

  /// "Failed to validate": none or several of the forms that the schema offers under oneOf; otherwise of a
  /// child, which has its own entry.
  void take_choice(const Path& path) {
    const json node = schema_at(schema_, path);
    if (!node.contains("oneOf")) return;
    const json& found = document_.at(json::json_pointer(pointer_text(path)));
    std::string keys;
    for (const std::string& key : keys_of(found)) keys += (keys.empty() ? "" : ", ") + key;
    report(path, "an object with " + (keys.empty() ? "nothing" : keys),
           node.value("allowed", "another object"));
    wrong_.push_back(path);
  }

  void take_unknown_keys(const Path& path) {
    const std::vector<std::string> known =
        keys_of(schema_at(schema_, path).value("properties", json::object()));
    for (const auto& item : document_.at(json::json_pointer(pointer_text(path))).items()) {
      if (std::find(known.begin(), known.end(), item.key()) != known.end()) continue;
      Path child = path;
      child.push_back(item.key());
      report(child, "the unknown key \"" + item.key() + '"',
             unknown_name("", item.key(), known).violations().front().allowed);
      wrong_.push_back(child);
    }
  }

  void report(const Path& path, std::string found, std::string allowed) {
    const std::string where = source_ + "#" + shortened(pointer_text(path));
    found = shortened(found);
    if (seen_.insert(where).second) violations_.push_back({where, std::move(found), std::move(allowed)});
  }

  json& document_;
  const std::string& source_;
  std::vector<Violation>& violations_;
  const json schema_;
  std::vector<Path> wrong_;
  std::set<std::string> seen_;
};

/// All errors, parents' included.
valijson::ValidationResults validate(const json& document, const json& schema_text) {
  valijson::Schema schema;
  valijson::SchemaParser().populateSchema(valijson::adapters::NlohmannJsonAdapter(schema_text), schema);
  valijson::ValidationResults results;
  valijson::Validator().validate(schema, valijson::adapters::NlohmannJsonAdapter(document), &results);
  return results;
}

}  // namespace

void check_schema(json& document, const std::string& schema, const std::string& source,
                  std::vector<Violation>& violations) {
  json rules = json::parse(schema);
  const valijson::ValidationResults results = validate(document, rules);
  Collector collector(document, std::move(rules), source, violations);
  for (const auto& error : results) collector.take(error);
  collector.remove_wrong();
}

std::vector<std::string> validate_json(const std::string& document, const std::string& schema) {
  std::vector<std::string> messages;
  for (const auto& error : validate(json::parse(document), json::parse(schema))) {
    messages.push_back(pointer_text(to_path(error.context)) + ": " + error.description);
  }
  return messages;
}

}  // namespace bb
