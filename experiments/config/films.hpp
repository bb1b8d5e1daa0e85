// The film of a motion or of a rest shape: from JSON to its source, and from the source to positions. Private to experiments/config.
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/model/mesh/triangle_mesh.hpp"
#include "core/model/scene/film_source.hpp"
#include "experiments/config/reader.hpp"

namespace bb {

/// What rules a film: a generator with its own parameters, or numbered files.
Rule film_rule();
/// As it stands in a resolved config; null where there is none.
nlohmann::json film_json(const FilmSource& film);
/// Of an object that its rule has checked; an empty one is no film. Opens and hashes the files.
void read_film(const nlohmann::json& object, const std::string& pointer, const Reader& reader,
               FilmSource& film);

/// The film of a body with this mesh (before `transform` places it), frames placed by `transform`. Null where none is given.
/// Errors: ConfigError at the file, or at `where`: what parse_film_frame refuses, another number of times than of frames, times that
/// do not increase, files that have changed.
std::shared_ptr<const Film> make_film(const FilmSource& film, const TriangleMesh& mesh,
                                      const std::function<void(Positions&)>& transform,
                                      const std::string& where);

}  // namespace bb
