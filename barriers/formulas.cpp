#include "barriers/formulas.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <utility>

#include "barriers/shapes/registry.hpp"
#include "core/input/json.hpp"
#include "core/input/names.hpp"
#include "core/input/process.hpp"
#include "core/math/error.hpp"
#include "core/plugin/plugin.hpp"

namespace bb {
namespace {

using nlohmann::json;

constexpr std::size_t most_bytes = 400;  // as grammar.py has it

/// What is known of one text: the shape, or what is wrong with it.
struct Answer {
  std::optional<FormulaShape> shape;
  std::string found, allowed, at_zero;
};

std::string python() {
  const char* given = std::getenv("BARRIERBENCH_PYTHON");
  return given && *given ? given : BB_SOURCE_DIR "/.venv/bin/python";
}

Answer refused(std::string found, std::string allowed) {
  return {{}, std::move(found), std::move(allowed), {}};
}

/// Runs analysis/formula. Errors: none, they are answers.
Answer ask(const std::string& text) {
  const std::string program = python();
  const std::string environment =
      "the environment that ./bench setup makes, or another with sympy named by BARRIERBENCH_PYTHON";
  if (!std::filesystem::exists(program)) {
    return refused(fmt::format("a formula and no Python at \"{}\"", program), environment);
  }
  const Finished done = run_process({program, "-m", "analysis.formula"}, json{{"formula", text}}.dump(),
                                    {{"PYTHONPATH", BB_SOURCE_DIR}});
  const std::size_t end = done.out.find_last_not_of('\n');
  const std::string last =
      end == std::string::npos ? "" : done.out.substr(done.out.rfind('\n', end) + 1, end + 1);
  const json answer = json::parse(last, nullptr, false);
  if (done.code != 0 || !answer.is_object()) {
    return refused(fmt::format("a formula that \"{}\" gave no answer to: exit code {}, {}", program,
                               done.code, shortened(last)),
                   environment);
  }
  if (answer.contains("found")) return refused(answer.at("found"), answer.at("allowed"));
  Plugin plugin = load_plugin(answer.at("library"));
  FormulaShape out{plugin.shapes.at(0), answer.at("label"), answer.at("library"),
                   answer.at("library_sha256")};
  out.shape.name = std::string(formula_prefix) + answer.at("formula").get<std::string>();
  out.shape.doc = "a formula";
  return {std::move(out), {}, {}, answer.at("at_zero")};
}

/// Asked once for every text of this process.
const Answer& known(const std::string& text) {
  static std::mutex mutex;
  static std::map<std::string, Answer> answers;
  const std::lock_guard lock(mutex);
  const auto found = answers.find(text);
  if (found != answers.end()) return found->second;
  const Answer answer = ask(text);
  if (answer.shape) answers.emplace(answer.shape->shape.name.substr(formula_prefix.size()), answer);
  return answers.emplace(text, answer).first->second;
}

ParameterList formula_list() {
  ParameterList list;
  list.doc = "A shape as a formula, b in m^2 of the gap d and of d_hat (m).";
  list.rows = {{"formula", required(text_up_to(most_bytes)), no_default,
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
  if (text.size() > most_bytes) {
    throw ConfigError(std::string(where), fmt::format("{} characters", text.size()),
                      fmt::format("at most {}", most_bytes));
  }
  const Answer& answer = known(std::string(text));
  if (!answer.shape) throw ConfigError(std::string(where), answer.found, answer.allowed);
  if (at_zero && *at_zero != answer.at_zero) {
    throw ConfigError(std::string(where), fmt::format("at_zero \"{}\"", *at_zero),
                      fmt::format("\"{}\", which is what this formula does as d -> 0", answer.at_zero));
  }
  return *answer.shape;
}

Rule shape_rule() {
  Rule rule = name_in(shape_names);
  rule.list = [](const json&) { return formula_list(); };
  return rule;
}

std::vector<FormulaShape> formulas_of(const std::vector<std::string>& shape_names) {
  std::map<std::string, FormulaShape> out;
  for (const std::string& name : shape_names) {
    if (is_formula(name)) {
      out.emplace(name, require_formula(name.substr(formula_prefix.size()), {}, "shape"));
    }
  }
  std::vector<FormulaShape> list;
  for (auto& [name, shape] : out) list.push_back(std::move(shape));
  return list;
}

}  // namespace bb
