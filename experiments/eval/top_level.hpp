// The raw text of the top-level members of a JSON object, so that an id is echoed exactly as it was written,
// whatever its type and however many digits it has.
#pragma once

#include <string_view>
#include <utility>
#include <vector>

namespace bb::eval {

/// Member names (still escaped, without quotes) and values as written. Requires text to be one JSON
/// object as far as brackets and strings go; returns what was read up to the first place where it is
/// not. Cost O(length).
std::vector<std::pair<std::string_view, std::string_view>> top_level_members(std::string_view text);

}  // namespace bb::eval
