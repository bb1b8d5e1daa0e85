// What the identity of a config leaves out of it.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace bb {

/// The value with every object that has `file` and `sha256` keeping of the file its suffix alone: a file is known by its content
/// and by the suffix that chooses its reader, never by where it lies.
nlohmann::json without_places(nlohmann::json value);

}  // namespace bb
