// Rest shapes that are given as functions of time.
#pragma once

#include <memory>
#include <vector>

#include "core/model/scene/film.hpp"

namespace bb {

/// Factor on the rest lengths of a body at a time.
struct ShrinkKey {
  double time = 0;   // s
  double value = 1;  // > 0
};

/// The rest shape of a body: that of a film, where there is one, times a factor.
struct RestMotion {
  int first_vertex = 0, n_vertices = 0;        // of the scene
  std::shared_ptr<const Film> film = nullptr;  // absent: Scene::rest
  std::vector<ShrinkKey> factors;              // empty: 1
};

}  // namespace bb
