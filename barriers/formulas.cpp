#include "barriers/formulas.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <utility>

#include "barriers/shapes/registry.hpp"
#include "core/base/input/json.hpp"
#include "core/base/input/names.hpp"
#include "core/base/input/process.hpp"
#include "core/math/error.hpp"
#include "core/model/plugin/plugin.hpp"

namespace bb {
namespace {

using nlohmann::json;

/// What is known of one text: the plugin that was made of it, or what is wrong with it.
struct Answer {
  std::optional<Plugin> plugin;
  std::string formula;  // its one spelling
  FormulaLibrary library;
  std::string found, allowed, at_zero;  // at_zero: of a shape
  bool reads_gap = false;               // of a policy
  double slope_error = 0;               // of a policy
};

constexpr InputKind ptx_file{"the PTX of a formula", std::uint64_t{64} << 20};

std::string python() {
  const char* given = std::getenv("BARRIERBENCH_PYTHON");
  return given && *given ? given : BB_SOURCE_DIR "/.venv/bin/python";
}

Answer refused(std::string found, std::string allowed) {
  Answer out;
  out.found = std::move(found);
  out.allowed = std::move(allowed);
  return out;
}

json no_answer(std::string found) {
  return {{"found", std::move(found)},
          {"allowed",
           "the environment that ./bench setup makes, or another with sympy named by BARRIERBENCH_PYTHON"}};
}

/// What analysis/src/barrierbench_analysis/program/formula answers; `found` and `allowed` where something is wrong.
json asked(const json& question) {
  const std::string program = python();
  if (!std::filesystem::exists(program)) {
    return no_answer(fmt::format("a formula and no Python at \"{}\"", program));
  }
  const Finished done = run_process({program, "-m", "barrierbench_analysis.program.formula"}, question.dump(),
                                    {{"PYTHONPATH", BB_SOURCE_DIR "/analysis/src"}});
  const std::size_t end = done.out.find_last_not_of('\n');
  const std::string last =
      end == std::string::npos ? "" : done.out.substr(done.out.rfind('\n', end) + 1, end + 1);
  json answer = json::parse(last, nullptr, false);
  if (done.code == 0 && answer.is_object()) return answer;
  return no_answer(fmt::format("a formula that \"{}\" gave no answer to: exit code {}, {}", program,
                               done.code, shortened(last)));
}

/// Of a shape or a policy. Errors: none, they are answers.
Answer ask(const std::string& kind, const std::string& text) {
  const json answer = asked({{"kind", kind}, {"formula", text}});
  if (answer.contains("found")) return refused(answer.at("found"), answer.at("allowed"));
  const std::string formula = answer.at("formula");
  return {load_plugin(answer.at("library")),
          formula,
          {std::string(formula_prefix) + formula, answer.at("label"), answer.at("library"),
           answer.at("library_sha256"), answer.value("unproven", "")},
          {},
          {},
          answer.value("at_zero", ""),
          answer.value("reads_gap", false),
          answer.value("slope_error_rel", 0.0)};
}

/// The library of a text, which Python compiles once in this process. Errors: ConfigError at `where`.
const Answer& known(const std::string& kind, std::string_view text, std::string_view where) {
  static std::mutex mutex;
  static std::map<std::pair<std::string, std::string>, Answer> answers;
  if (text.size() > most_formula_bytes) {
    throw ConfigError(std::string(where), fmt::format("{} characters", text.size()),
                      fmt::format("at most {}", most_formula_bytes));
  }
  const std::lock_guard lock(mutex);
  const auto key = std::pair(kind, std::string(text));
  auto found = answers.find(key);
  if (found == answers.end()) {
    const Answer answer = ask(kind, key.second);
    if (answer.plugin) answers.emplace(std::pair(kind, answer.formula), answer);
    found = answers.emplace(key, answer).first;
  }
  const Answer& answer = found->second;
  if (!answer.plugin) throw ConfigError(std::string(where), answer.found, answer.allowed);
  return answer;
}

struct KernelAnswer {
  std::optional<DeviceCode> code;
  std::string found, allowed;
};

KernelAnswer ask_for_kernel(const std::string& formula, std::uint64_t layout) {
  const json answer = asked({{"kind", "device"}, {"formula", formula}, {"layout", layout}});
  if (answer.contains("found")) return {{}, answer.at("found"), answer.at("allowed")};
  const std::string file = answer.at("ptx");
  return {DeviceCode{read_input_file(file, ptx_file), answer.at("entry"), file, answer.at("ptx_sha256")}, "",
          ""};
}

/// The kernel of a formula's shape, requested once. Errors: ConfigError without nvcc.
const DeviceCode& device_code_of(const Shape& shape, std::uint64_t layout) {
  static std::mutex mutex;
  static std::map<std::string, KernelAnswer> answers;
  const std::lock_guard lock(mutex);
  auto found = answers.find(shape.name);
  if (found == answers.end()) {
    found =
        answers.emplace(shape.name, ask_for_kernel(shape.name.substr(formula_prefix.size()), layout)).first;
  }
  const KernelAnswer& answer = found->second;
  if (!answer.code) throw ConfigError("/formulation/shape", answer.found, answer.allowed);
  return *answer.code;
}

ParameterList formula_list() {
  ParameterList list;
  list.doc = "A shape as a formula, b in m^2 of the gap d and of d_hat (m).";
  list.rows = {{"formula", required(text_up_to(most_formula_bytes)), no_default,
                "Of d, d_hat, pi, numbers, + - * / ^ and functions such as log, exp, sqrt: "
                "-(d - d_hat)^2*log(d/d_hat)."},
               {"at_zero", word({"infinite", "finite"}), no_default,
                "What b does as d -> 0; a formula that does otherwise is refused."}};
  return list;
}

}  // namespace

bool is_formula(std::string_view shape_name) { return shape_name.starts_with(formula_prefix); }

FormulaShape require_formula(std::string_view text, const std::optional<std::string>& at_zero,
                             std::string_view where) {
  const Answer& answer = known("shape", text, where);
  if (at_zero && *at_zero != answer.at_zero) {
    throw ConfigError(std::string(where), fmt::format("at_zero \"{}\"", *at_zero),
                      fmt::format("\"{}\", which is what this formula does as d -> 0", answer.at_zero));
  }
  FormulaShape out{answer.plugin->shapes.at(0), answer.library};
  out.shape.name = answer.library.name;
  out.shape.doc = "a formula";
  out.shape.device_code = device_code_of;
  return out;
}

FormulaPolicy require_policy_formula(std::string_view text, std::string_view where) {
  const Answer& answer = known("policy", text, where);
  const auto in_gap =
      reinterpret_cast<FormulaInGap>(find_symbol(answer.library.file, "barrierbench_formula_in_gap"));
  return {answer.formula,    answer.plugin->policies.at(0), answer.library, in_gap, answer.reads_gap,
          answer.slope_error};
}

Rule shape_rule() {
  Rule rule = name_in(shape_names);
  rule.list = [](const json&) { return formula_list(); };
  return rule;
}

std::vector<FormulaLibrary> formula_libraries(const std::vector<std::string>& shape_names,
                                              const std::vector<std::string>& policies) {
  std::map<std::string, FormulaLibrary> out;
  const auto add = [&out](const FormulaLibrary& library) { out.emplace(library.name, library); };
  for (const std::string& name : shape_names) {
    if (is_formula(name)) add(require_formula(name.substr(formula_prefix.size()), {}, "shape").library);
  }
  for (const std::string& text : policies) add(require_policy_formula(text, "stiffness_policy").library);
  std::vector<FormulaLibrary> list;
  for (auto& [name, library] : out) list.push_back(std::move(library));
  return list;
}

}  // namespace bb
