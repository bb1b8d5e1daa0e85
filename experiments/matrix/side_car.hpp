// Reading the side-car of a matrix: every fault with its JSON pointer.
#pragma once

#include <string>

#include "experiments/matrix/system_file.hpp"

namespace bb {

/// Fills what the file knows into `stored`, whose matrix is there. Only `schema` and `rhs` are required.
/// @param matrix_sha256  of the bytes of the matrix's file
/// Errors: ConfigError with all that is wrong at once.
void read_side_car(const std::string& path, const std::string& matrix_sha256, StoredSystem& stored);

/// The same from text; `path` is used in messages.
void parse_side_car(const std::string& text, const std::string& path, const std::string& matrix_sha256,
                    StoredSystem& stored);

}  // namespace bb
