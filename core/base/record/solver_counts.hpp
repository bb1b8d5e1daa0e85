// What a step solver counts of its own steps, beside WorkCounts. Which numbers there are is declared by the entry of the
// step solver (core/newton/step_solver.hpp); fields, schema and dictionary come from that.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace bb {

/// How the numbers of the steps make one of the run.
enum class OverSteps { sum, largest, smallest };
constexpr std::string_view to_string(OverSteps over) {
  if (over == OverSteps::sum) return "sum";
  return over == OverSteps::largest ? "largest" : "smallest";
}

struct SolverCounter {
  std::string name;  // of the field; its end is its unit (unit_of in schema.hpp), none: 1
  std::string doc;
  OverSteps over_steps = OverSteps::sum;
};

/// Counter -> number.
struct SolverCounts {
  std::map<std::string, double> values;

  /// Takes up those of another step.
  void add(const std::vector<SolverCounter>& counters, const SolverCounts& other) {
    for (const SolverCounter& counter : counters) {
      const auto found = other.values.find(counter.name);
      if (found == other.values.end()) continue;
      const auto [own, first] = values.try_emplace(counter.name, found->second);
      if (first) continue;
      if (counter.over_steps == OverSteps::sum) own->second += found->second;
      if (counter.over_steps == OverSteps::largest) own->second = std::max(own->second, found->second);
      if (counter.over_steps == OverSteps::smallest) own->second = std::min(own->second, found->second);
    }
  }
};

}  // namespace bb
