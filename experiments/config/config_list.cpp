#include "experiments/config/config_list.hpp"

#include "core/base/input/json.hpp"
#include "core/base/input/names.hpp"
#include "core/base/parameters/check.hpp"
#include "experiments/config/renamed_settings.hpp"

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

ParameterList range_list() {
  return {"Numbers from one end to the other, both among them; those between are rounded to 12 digits.",
          {{"from", required(any_number("")), no_default, "The first value."},
           {"to", required(any_number("")), no_default, "The last value."},
           {"count", required(count(2, max_sweep_cases)), no_default, "How many values."},
           {"scale", word({"linear", "log"}), "linear",
            "Equal differences, or equal ratios: with log both ends have one sign."}},
          false,
          {},
          ""};
}

/// The rows of an axis that is no zip.
std::vector<Parameter> axis_rows() {
  return {
      {"pointer", text_up_to(0), no_default, "JSON pointer into the config, e.g. /time/dt_s."},
      {"values", values(), no_default, "Values of the pointer, one case each; a case is labelled KEY=VALUE."},
      {"range", listed(Kind::object, 0, range_list), no_default, "The same as numbers between two ends."},
      {"cases", listed(Kind::objects, 1, case_list), no_default, "Cases of their own."}};
}

ParameterList zipped_list() {
  return {"One of the axes that are zipped.",
          axis_rows(),
          false,
          {{"pointer", "values"}, {"pointer", "range"}, {"cases"}},
          "{pointer, values}, {pointer, range} or {cases: [{label, set}]}"};
}

ParameterList axis_list() {
  std::vector<Parameter> rows = axis_rows();
  Rule zip = listed(Kind::objects, 2, zipped_list);
  zip.max_size = max_zipped;
  rows.push_back(
      {"zip", zip, no_default,
       "Axes of one length that go along with one another: entry k sets what entry k of each sets."});
  return {
      "One pointer and the values it takes, or cases that each set several pointers, or such axes zipped.",
      std::move(rows),
      false,
      {{"pointer", "values"}, {"pointer", "range"}, {"cases"}, {"zip"}},
      "{pointer, values}, {pointer, range: {from, to, count}}, {cases: [{label, set}]} or {zip: [axis, "
      "axis]}"};
}

/// JSON pointer: a value, or a list of them.
ParameterList where_list() {
  return {"JSON pointer that an axis sets: the value, or a list of values, that it has in what is left out.",
          {},
          true,
          {},
          ""};
}

ParameterList exclude_list() {
  return {"Combinations that are left out: those that have all that is named here.",
          {{"where", listed(Kind::object, 0, where_list), no_default, ""},
           {"labels", values(), no_default, "Labels of entries, each of another axis."}},
          false,
          {},
          ""};
}

ParameterList budget_list() {
  return {
      "What the sweep may cost.",
      {{"core_s", positive("s"), no_default,
        "Seconds times threads of all runs together: once its records took as long no further run begins."},
       {"run_s", positive("s"), no_default,
        "Seconds that a run may take before it ends as timeout, as --time-limit."}},
      false,
      {},
      ""};
}

}  // namespace

ParameterList sweep_list() {
  return {
      "A base config and axes: every combination of one entry of each axis is one run, at most 100000 of "
      "them. A case "
      "takes `set` of the file, then the entry of the first axis, then of the second, and so on; a later one "
      "overrides an earlier one.",
      {{"schema", required(word({"barrierbench.sweep/1"})), no_default, "Version of this format."},
       {"name", required(text_up_to(max_name_bytes)), no_default,
        "Name of the sweep and of its folder: no /, no .., at most 150 bytes."},
       {"doc", free_text(), no_default, "Free text."},
       {"base", required(text_up_to(0)), no_default, "Path of a config, relative to this file."},
       {"set", listed(Kind::object, 0, overrides_list), no_default, ""},
       {"axes", required(listed(Kind::objects, 1, axis_list)), no_default,
        "Every combination of their entries is run."},
       {"exclude", listed(Kind::objects, 1, exclude_list), no_default, "Combinations that are left out."},
       {"repeat", count(1, max_sweep_cases), no_default,
        "How often every combination is run: labelled r1, r2, ..., with seeds of their own where `seed` is "
        "given."},
       {"seed", count(0, max_json_integer), no_default,
        "/seeds/main of every run is made of this number, of the repetition and of what those axes set that "
        "change "
        "neither method, formulation, strain limit nor matching: runs that are compared with one another "
        "share it. "
        "Needs /seeds/jitter_m."},
       {"budget", listed(Kind::object, 0, budget_list), no_default, "What the sweep may cost."}},
      false,
      {},
      ""};
}

nlohmann::ordered_json schema_document(const std::string& format) {
  nlohmann::ordered_json out = {{"$schema", "http://json-schema.org/draft-07/schema#"},
                                {"$id", "barrierbench." + format + "/1"}};
  out.update(schema_of(format == "sweep" ? sweep_list() : config_list()));
  if (format == "config") add_earlier_names(out);
  return out;
}

}  // namespace bb
