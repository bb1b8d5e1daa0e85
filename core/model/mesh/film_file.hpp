// Films as numbered mesh files: walk_0000.obj, walk_0001.obj, ...
#pragma once

#include <string>
#include <vector>

#include "core/model/mesh/triangle_mesh.hpp"

namespace bb {

/// The files of a film whose first one is `first`, in the order of the last number in their names; all else in the names, and the
/// folder, is the same. Smaller numbers than that of the first are no part of it.
/// Errors: ConfigError naming the file: a name without a number, a second file that there is not, two files of one number, a number
/// that is missing between two.
std::vector<std::string> film_files(const std::string& first);

/// times.csv beside them, as `bench data frames` writes it; empty: there is none.
std::string film_times_file(const std::string& first);
/// Its column time_s, s. Errors: ConfigError naming the line.
std::vector<double> parse_film_times(const std::string& bytes, const std::string& name);

/// Positions [3 x n] of a frame from the bytes of its file, in its units, taken as m. Its cells are those of the mesh, where it has some.
/// Errors: ConfigError naming the file: those of parse_frame, another number of vertices, other cells, a coordinate that is not
/// finite or beyond max_coordinate.
Positions parse_film_frame(const std::string& bytes, const std::string& name, const TriangleMesh& of);

}  // namespace bb
