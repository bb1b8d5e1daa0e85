// The weight groups of a body: from JSON to their sources, and from the sources to a number a vertex. Private to experiments/config.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/model/bodies/body_spec.hpp"
#include "experiments/config/reader.hpp"

namespace bb {

/// What the rows of the groups do not express: each has one source. body: the object that has them, which the rules have checked. Hashes the
/// files.
void read_weights(const nlohmann::json& body, const std::string& pointer, const Reader& reader,
                  std::vector<WeightGroupConfig>& groups);

/// start: where the vertices of the body start, m. where: the body.   Errors: ConfigError at the file and its line: a word that is no
/// number in [0, 1], another number of lines than of vertices, a file that has changed; those of formula_weights.
std::vector<WeightGroup> make_weights(const std::vector<WeightGroupConfig>& groups, const Positions& start,
                                      const std::string& where);

}  // namespace bb
