#include "core/model/bodies/weights.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace bb {
namespace {

const WeightGroup* find_group(const std::vector<WeightGroup>& groups, const std::string& name) {
  const auto found = std::find_if(groups.begin(), groups.end(),
                                  [&](const WeightGroup& group) { return group.name == name; });
  return found == groups.end() ? nullptr : &*found;
}

void check_groups(const Complaints& report, const BodySpec& spec) {
  std::set<std::string> names;
  for (const WeightGroup& group : spec.weights) {
    const std::string what = "/weights \"" + group.name + '"';
    if (!names.insert(group.name).second) report(what, "a name used twice", "one group a name");
    if (group.weight.size() != static_cast<std::size_t>(spec.mesh.n_vertices())) {
      report(what, fmt::format("{} numbers", group.weight.size()),
             fmt::format("{}, one a vertex of the body", spec.mesh.n_vertices()));
    }
    for (std::size_t v = 0; v < group.weight.size(); ++v) {
      if (group.weight[v] >= 0 && group.weight[v] <= 1) continue;
      report(what, fmt::format("{} of vertex {}", group.weight[v], v), "a number in [0, 1]");
      break;
    }
  }
}

bool good_influence(double value) { return value >= -1 && value <= 1; }

void check_keys(const Complaints& report, const std::string& what, const std::vector<InfluenceKey>& keys) {
  for (std::size_t k = 0; k < keys.size(); ++k) {
    report.number(what + "/influence_schedule", keys[k].value, good_influence(keys[k].value),
                  "numbers in [-1, 1]");
    if (k > 0 && !(keys[k].time > keys[k - 1].time)) {
      report(what + "/influence_schedule",
             fmt::format("time {:g} after {:g}", keys[k].time, keys[k - 1].time), "times that increase (s)");
    }
  }
}

/// constant: why influences have to be; empty: they may change.
void check_mix(const Complaints& report, const BodySpec& spec, const std::string& what,
               const std::vector<WeightShare>& mix, const std::string& constant) {
  for (const WeightShare& share : mix) {
    require_group(report, spec.weights, what, share.group);
    report.number(what + "/influence", share.influence, good_influence(share.influence),
                  "a number in [-1, 1]");
    check_keys(report, what, share.keys);
    if (!share.keys.empty() && !constant.empty()) {
      report(what + "/influence_schedule", "influences that change", "constant ones: " + constant);
    }
  }
}

void check_pin(const Complaints& report, const BodySpec& spec, const PinSpec& pin) {
  check_mix(report, spec, "/pins/mix", pin.mix, pin.threshold ? "threshold selects vertices once" : "");
  if (pin.threshold) {
    report.number("/pins/threshold", *pin.threshold, *pin.threshold > 0 && *pin.threshold <= 1,
                  "a number in (0, 1]");
    if (pin.mix.empty()) report("/pins/threshold", "a threshold of no weights", "mix beside it");
  } else if (!pin.mix.empty() && !pin.pull) {
    report("/pins/mix", "weights of vertices that are prescribed",
           "threshold beside it, which selects them, or pull_N_per_m, whose stiffness they multiply");
  }
}

/// Whether the body has stiffnesses of that kind.
bool has_stiffness(const Material& m, StiffnessKind kind) {
  if (kind == StiffnessKind::membrane) return m.model != "none";
  if (kind == StiffnessKind::hinges) return m.hinges_bend();
  return m.springs > 0 || m.rod_stretching > 0 || m.has_sides() || m.has_diagonals();
}

void check_stiffness(const Complaints& report, const BodySpec& spec) {
  std::set<StiffnessKind> kinds;
  for (const StiffnessWeights& weights : spec.stiffness_weights) {
    check_mix(report, spec, "/stiffness_weights/mix", weights.mix, "stiffnesses stay");
    if (weights.mix.empty()) report("/stiffness_weights/mix", "no group", "at least one");
    for (const double factor : {weights.low, weights.high})
      report.number("/stiffness_weights", factor, factor >= 0, "factors >= 0");
    if (!kinds.insert(weights.of).second)
      report("/stiffness_weights/of", "one kind of stiffness twice", "each once");
    if (!has_stiffness(spec.material, weights.of))
      report("/stiffness_weights/of", "a stiffness that the material has not", "one that is not 0");
  }
}

}  // namespace

const WeightGroup* require_group(const Complaints& report, const std::vector<WeightGroup>& groups,
                                 const std::string& what, const std::string& name) {
  const WeightGroup* const found = find_group(groups, name);
  if (found != nullptr) return found;
  std::vector<std::string> names;
  for (const WeightGroup& group : groups) names.push_back(group.name);
  report(what, fmt::format("the weight group \"{}\"", name),
         names.empty() ? "nothing: the body has no weights"
                       : fmt::format("a group of the body: {}", fmt::join(names, ", ")));
  return nullptr;
}

void check_weights(const Complaints& report, const BodySpec& spec) {
  check_groups(report, spec);
  for (const PinSpec& pin : spec.pins) check_pin(report, spec, pin);
  check_mix(report, spec, "/pressure_mix", spec.pressure_mix, "");
  if (!spec.pressure_mix.empty() && spec.pressure == 0 && spec.pressure_keys.empty()) {
    report("/pressure_mix", "weights of no pressure", "pressure_Pa or pressure_schedule beside them");
  }
  check_stiffness(report, spec);
}

WeightMix mix_of(const BodySpec& spec, const std::vector<WeightShare>& shares) {
  WeightMix out;
  for (const WeightShare& share : shares) {
    out.layers.push_back({find_group(spec.weights, share.group)->weight, share.influence, share.keys});
  }
  return out;
}

WeightMix mix_of(const BodySpec& spec, const std::vector<WeightShare>& shares,
                 const std::vector<int>& vertices, int first) {
  WeightMix out = mix_of(spec, shares);
  for (WeightLayer& layer : out.layers) {
    std::vector<double> some;
    for (const int v : vertices) some.push_back(layer.weight[static_cast<std::size_t>(v - first)]);
    layer.weight = std::move(some);
  }
  return out;
}

StiffnessFactors::StiffnessFactors(const BodySpec& spec) {
  for (const StiffnessWeights& weights : spec.stiffness_weights) {
    kinds_[static_cast<std::size_t>(weights.of)] = {mix_of(spec, weights.mix).at(0), weights.low,
                                                    weights.high};
  }
}

}  // namespace bb
