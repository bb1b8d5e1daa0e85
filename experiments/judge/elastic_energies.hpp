// Energy of the elements that bodies of a subject are made of: what this program computes of the same positions.
#pragma once

#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/math/types.hpp"

namespace bb::judge {

/// Bodies with their materials, as a config; its vertex k is the vertex vertices[k] of the subject.
struct ElasticPart {
  std::string config;
  std::vector<int> vertices;
};

class ElasticEnergies {
 public:
  /// given: [n_vertices of the subject] not 0 where the scene moves a vertex; empty: nowhere.
  /// Errors: ConfigError of the config, and where it has another number of vertices than the list.
  ElasticEnergies(const ElasticPart& part, const std::vector<std::uint8_t>& given);
  ~ElasticEnergies();

  /// Energies (J) at x [3 x n_vertices of the subject], one for each kind of element in use. Cost: O(elements).
  nlohmann::ordered_json energies(const Positions& x);
  /// Work (J) of what holds the given vertices against elastic forces, from the positions of the call before to x: the mean
  /// of both forces times the way, so that its error is of second order in the way. 0 at the first call.
  double work_of_given(const Positions& x);

 private:
  struct Elements;
  std::unique_ptr<Elements> elements_;
};

}  // namespace bb::judge
