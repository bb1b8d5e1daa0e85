// Barriers and stiffnesses of a strain limit that have kernels.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "tests/barriers/limit_policies.hpp"

namespace bb::test {

struct LimitRule {
  const char* shape;
  std::optional<ElasticityInclusive> elastic;  // else fixed
  double tolerance;                            // relative: 0 where the arithmetic is the same

  std::unique_ptr<StiffnessPolicy> policy() const {
    return elastic ? elastic_limit(*elastic, 1.7) : fixed_limit(30);
  }
};

inline ElasticityInclusive elastic_rule(MassTerm mass, bool with_h, Refresh refresh,
                                        KappaDerivative derivative) {
  return {mass, with_h, refresh, 0.01, derivative};
}

inline std::vector<LimitRule> limit_rules() {
  std::vector<LimitRule> out;
  constexpr std::nullopt_t fixed = std::nullopt;
  out.push_back({"quadratic", fixed, 0});
  out.push_back({"log", fixed, 1e-13});
  out.push_back({"log_squared", fixed, 1e-12});
  out.push_back({"two_stage", fixed, 1e-13});
  out.push_back({"exponential", fixed, 1e-13});
  constexpr auto dropped = KappaDerivative::dropped;
  for (const MassTerm mass : {MassTerm::paper, MassTerm::inertia, MassTerm::scaled, MassTerm::none}) {
    out.push_back({"cubic", elastic_rule(mass, true, Refresh::per_iteration, dropped), 0});
  }
  out.push_back({"cubic", elastic_rule(MassTerm::paper, false, Refresh::per_step, dropped), 0});
  for (const char* shape : {"quadratic", "cubic"}) {
    out.push_back(
        {shape, elastic_rule(MassTerm::paper, true, Refresh::per_step, KappaDerivative::included), 1e-12});
  }
  return out;
}

}  // namespace bb::test
