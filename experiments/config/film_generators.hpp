// Generators of films that a config can name: poses of a mesh as functions of time.
#pragma once

#include <string>
#include <vector>

#include "core/base/parameters/parameter.hpp"
#include "core/base/parameters/registry.hpp"
#include "core/math/types.hpp"

namespace bb {

struct FilmGenerator {
  std::string name, doc;
  std::vector<Parameter> parameters;
  /// Where the vertices of a mesh at x are at the time t (s); x itself at 0.
  Positions (*pose)(const Positions& x, const ParameterMap& complete, double t) = nullptr;
};

/// Each has the rows n_frames and duration_s besides its own.
const Registry<FilmGenerator>& film_generators();

}  // namespace bb
