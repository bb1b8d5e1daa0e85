// Where the elements of one body go while a scene is built.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "core/model/bodies/complaints.hpp"
#include "core/model/bodies/weights.hpp"
#include "core/model/scene/scene.hpp"

namespace bb {

/// Adds a mass (kg) to a vertex of the body.
using AddMass = std::function<void(int vertex, double mass)>;

/// The elements of that model among those of a part, one list a model; begun where there are none yet.
template <class List>
List& of_model(const std::string& model, std::vector<List>& lists) {
  const auto found =
      std::find_if(lists.begin(), lists.end(), [&](const List& list) { return list.model == model; });
  if (found != lists.end()) return *found;
  lists.emplace_back().model = model;
  return lists.back();
}

struct BodyElements {
  Scene& scene;
  const int first;                 // vertex 0 of the body in the scene
  const std::vector<int>& pin_of;  // [n vertices of the scene] -1: free
  const Complaints& complain;      // at the body
  const StiffnessFactors& stiffness;

  /// The same vertices, numbered as those of the scene.
  template <std::size_t n>
  std::array<int, n> in_scene(std::array<int, n> vertices) const {
    for (int& v : vertices) v += first;
    return vertices;
  }
  /// vertices: of the scene.
  template <std::size_t n>
  bool all_prescribed(const std::array<int, n>& vertices) const {
    return std::all_of(vertices.begin(), vertices.end(),
                       [this](int v) { return pin_of[static_cast<std::size_t>(v)] >= 0; });
  }
};

}  // namespace bb
