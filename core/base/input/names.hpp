// Names and texts that a user gives: names that become part of a path, texts for messages.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/math/error.hpp"

namespace bb {

/// Bytes; with a scene's name and an id behind it a folder name stays below the 255 of file systems.
inline constexpr std::size_t max_name_bytes = 150;

/// Appends a violation at `where` unless the name has 1 to max_name_bytes bytes, does not start with a dot,
/// and holds no slash, no backslash, no "..", and no control character. Returns whether it was plain.
bool check_plain_name(const std::string& where, std::string_view name, std::vector<Violation>& violations);

/// The text, cut behind about 100 bytes where it is longer; for messages. Never cuts a character of UTF-8.
std::string shortened(std::string_view text);

/// Whether a byte or character of it would move the cursor of a terminal or give it a command: below a blank, DEL, and what
/// Unicode calls C1.
bool has_control_character(std::string_view text);

/// The text as it can be shown: control characters other than a line's end and a tab, and bytes that are no UTF-8, as \x1b.
std::string printable(std::string_view text);

/// True when the bytes are UTF-8, which JSON has to be.
bool is_utf8(std::string_view text);

}  // namespace bb
