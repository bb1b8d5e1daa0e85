// The hand-made queries of Wang et al. 2021 ("A large-scale benchmark and an inclusion-based algorithm for continuous
// collision detection"): rational coordinates with ground truth.
#pragma once

#include <string>

#include "experiments/ccd/query.hpp"

namespace bb::ccd {

/// Every *.csv in FOLDER/SCENE/vertex-face and FOLDER/SCENE/edge-edge, in the order of their names. A query has eight
/// rows: four vertices at t = 0, then at t = 1; a row has numerator and denominator of x, y and z, then the truth, 0 or
/// 1, the same in all eight. Vertex-face: v f0 f1 f2; edge-edge: ea0 ea1 eb0 eb1. Coordinates are rounded to the
/// nearest double.
/// Errors: ConfigError at file:line for a row that is none of these or beyond 1e15 m, at the folder when it is none or
/// has no query.
QuerySet read_queries(const std::string& folder);

/// The queries of one file; `name` is used in messages. Errors: ConfigError as above.
std::vector<Query> parse_queries(const std::string& text, const std::string& name);

}  // namespace bb::ccd
