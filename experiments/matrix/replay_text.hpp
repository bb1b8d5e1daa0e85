// What a replay says: a table for people, JSON for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "experiments/matrix/replay.hpp"

namespace bb {

inline constexpr const char* replay_schema = "barrierbench.matrix_replay/1";

/// Size, origin, right-hand side; a line a solve; a line an estimate.
std::string replay_table(const std::string& path, const StoredSystem& stored, const Replay& replay);
/// One element of `matrices` in the file of --json. A number that is unknown is null.
nlohmann::ordered_json replay_json(const std::string& path, const StoredSystem& stored, const Replay& replay);

}  // namespace bb
