#include "experiments/config/config_list.hpp"

#include "core/input/names.hpp"
#include "core/parameters/check.hpp"

namespace bb {
namespace {

Rule listed(Kind kind, std::size_t min_size, ParameterList (*list)()) {
  Rule rule;
  rule.kind = kind;
  rule.min_size = min_size;
  rule.list = [list](const nlohmann::json&) { return list(); };
  return rule;
}

Rule values() {
  Rule rule;
  rule.kind = Kind::values;
  rule.min_size = 1;
  return rule;
}

/// JSON pointer into the config: value.
ParameterList overrides_list() {
  ParameterList list{
      "JSON pointer into the config: value. Like --set on the command line, e.g. {\"/time/dt_s\": 0.005}.",
      {},
      true,
      {},
      ""};
  return list;
}

ParameterList case_list() {
  return {"One entry of an axis.",
          {{"label", required(text_up_to(max_name_bytes)), no_default,
            "Names the case in tables and in its folder: no /, no .., at most 150 bytes."},
           {"set", required(listed(Kind::object, 0, overrides_list)), no_default, ""},
           {"reference", flag(), false, "The case that the others are compared with."}},
          false,
          {},
          ""};
}

ParameterList axis_list() {
  return {"Either one pointer and the values it takes, or cases that each set several pointers.",
          {{"pointer", text_up_to(0), no_default, "JSON pointer into the config, e.g. /time/dt_s."},
           {"values", values(), no_default,
            "Values of the pointer, one case each; a case is labelled KEY=VALUE."},
           {"cases", listed(Kind::objects, 1, case_list), no_default, "Cases of their own."}},
          false,
          {{"pointer", "values"}, {"cases"}},
          "{pointer, values} or {cases: [{label, set}]}"};
}

}  // namespace

ParameterList sweep_list() {
  return {
      "A base config and axes: every combination of one entry of each axis is one run, at most 10000 of "
      "them. A case "
      "takes `set` of the file, then the entry of the first axis, then of the second, and so on; a later one "
      "overrides an earlier one.",
      {{"schema", required(word({"barrierbench.sweep/1"})), no_default, "Version of this format."},
       {"name", required(text_up_to(max_name_bytes)), no_default,
        "Name of the sweep and of its folder: no /, no .., at most 150 bytes."},
       {"doc", any_text(), no_default, "Free text."},
       {"base", required(text_up_to(0)), no_default, "Path of a config, relative to this file."},
       {"set", listed(Kind::object, 0, overrides_list), no_default, ""},
       {"axes", required(listed(Kind::objects, 1, axis_list)), no_default,
        "Every combination of their entries is run."}},
      false,
      {},
      ""};
}

nlohmann::ordered_json schema_document(const std::string& format) {
  nlohmann::ordered_json out = {{"$schema", "http://json-schema.org/draft-07/schema#"},
                                {"$id", "barrierbench." + format + "/1"}};
  out.update(schema_of(format == "sweep" ? sweep_list() : config_list()));
  return out;
}

}  // namespace bb
