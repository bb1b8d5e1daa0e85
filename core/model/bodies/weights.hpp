// Weight groups of a body: checks, mixes, factors on stiffnesses. Private to core/model/bodies.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "core/model/bodies/body_spec.hpp"
#include "core/model/bodies/complaints.hpp"

namespace bb {

/// Groups that are there, weights in [0, 1], one a vertex, influences and keys in their ranges; what has to be constant.
void check_weights(const Complaints& report, const BodySpec& spec);

/// The group of that name; null where there is none, which is reported at `what`.
const WeightGroup* require_group(const Complaints& report, const std::vector<WeightGroup>& groups,
                                 const std::string& what, const std::string& name);

/// Of all vertices of the body. Requires a spec in which check_weights finds no fault.
WeightMix mix_of(const BodySpec& spec, const std::vector<WeightShare>& shares);
/// Of some of them, in their order; the body's own vertices are numbered from `first` on.
WeightMix mix_of(const BodySpec& spec, const std::vector<WeightShare>& shares,
                 const std::vector<int>& vertices, int first);

/// Factors on the stiffnesses of the elements of a body.
class StiffnessFactors {
 public:
  /// 1 everywhere.
  StiffnessFactors() = default;
  explicit StiffnessFactors(const BodySpec& spec);

  /// vertices: of the body.
  template <std::size_t W>
  double of(StiffnessKind kind, const std::array<int, W>& vertices) const {
    const Kind& found = kinds_[static_cast<std::size_t>(kind)];
    return found.weight.empty() ? 1
                                : found.low + (found.high - found.low) * mean_weight(found.weight, vertices);
  }

 private:
  struct Kind {
    std::vector<double> weight;  // [n vertices]; empty: the factor is 1
    double low = 0, high = 1;
  };
  std::array<Kind, 3> kinds_;
};

}  // namespace bb
