// The registry of linear solvers and the words of their statuses.
#include "core/linear/linear_solver.hpp"

#include <algorithm>
#include <numeric>

#include "core/math/error.hpp"

namespace bb {

#define ENTRY(name, doc) std::unique_ptr<LinearSolver> make_##name(const LinearOptions&);
#include "core/linear/registry.inc"
#undef ENTRY

namespace {

using Maker = std::unique_ptr<LinearSolver> (*)(const LinearOptions&);
constexpr Maker kMakers[] = {
#define ENTRY(name, doc) make_##name,
#include "core/linear/registry.inc"
#undef ENTRY
};

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substitute = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substitute, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string_view to_string(LinearStatus status) {
  switch (status) {
    case LinearStatus::ok:
      return "ok";
    case LinearStatus::matrix_indefinite:
      return "matrix_indefinite";
    case LinearStatus::preconditioner_indefinite:
      return "preconditioner_indefinite";
    case LinearStatus::tolerance_below_rounding:
      return "tolerance_below_rounding";
    case LinearStatus::non_finite:
      return "non_finite";
    case LinearStatus::iteration_cap:
      return "iteration_cap";
  }
  return "";
}

const std::vector<LinearSolverEntry>& linear_solvers() {
  static const std::vector<LinearSolverEntry> entries = {
#define ENTRY(name, doc) {#name, doc},
#include "core/linear/registry.inc"
#undef ENTRY
  };
  return entries;
}

std::string did_you_mean(std::string_view found, const std::vector<std::string_view>& names) {
  const auto nearest = std::min_element(names.begin(), names.end(), [&](auto a, auto b) {
    return edit_distance(found, a) < edit_distance(found, b);
  });
  if (nearest == names.end() || edit_distance(found, *nearest) > 1 + nearest->size() / 3) return "";
  return " (did you mean " + std::string(*nearest) + "?)";
}

std::unique_ptr<LinearSolver> make_linear_solver(const LinearOptions& options) {
  std::vector<std::string_view> names;
  std::string list;
  for (std::size_t i = 0; i < linear_solvers().size(); ++i) {
    const std::string_view name = linear_solvers()[i].name;
    if (name == options.name) return kMakers[i](options);
    names.push_back(name);
    list += (list.empty() ? "" : ", ") + std::string(name);
  }
  throw ConfigError("/linear_solver/name", '"' + options.name + '"',
                    "one of " + list + did_you_mean(options.name, names));
}

}  // namespace bb
