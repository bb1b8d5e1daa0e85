#include "core/base/input/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace bb {
namespace {

/// The first character of a text: its bytes, and whether they are one of UTF-8 and whether it is a control character.
struct Character {
  std::string_view bytes;
  bool whole, control;
};

Character first_of(std::string_view text) {
  const auto byte = [text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  const std::size_t n = lead < 0x80   ? 1
                        : lead < 0xC2 ? 0
                        : lead < 0xE0 ? 2
                        : lead < 0xF0 ? 3
                        : lead < 0xF5 ? 4
                                      : 0;
  const bool whole = n == 1 || (n > 1 && n <= text.size() && is_utf8(text.substr(0, n)));
  const bool control = whole && (lead < 0x20 || lead == 0x7F || (lead == 0xC2 && byte(1) < 0xA0));
  return {text.substr(0, whole ? n : 1), whole, control};
}

std::string fault_of(std::string_view name) {
  if (name.empty()) return "an empty name";
  if (name.size() > max_name_bytes) {
    return fmt::format("a name of {} bytes, \"{}...\"", name.size(), name.substr(0, 20));
  }
  const bool control = has_control_character(name);
  const bool path = name.front() == '.' || name.find_first_of("/\\") != std::string_view::npos ||
                    name.find("..") != std::string_view::npos;
  if (!control && !path) return {};
  return nlohmann::json(name).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

}  // namespace

bool check_plain_name(const std::string& where, std::string_view name, std::vector<Violation>& violations) {
  std::string fault = fault_of(name);
  if (fault.empty()) return true;
  violations.push_back(
      {where, std::move(fault),
       fmt::format("a name of 1 to {} bytes, since folders are named after it: no /, \\, .. or "
                   "control character, no dot at its start",
                   max_name_bytes)});
  return false;
}

std::string shortened(std::string_view text) {
  constexpr std::size_t longest = 100;
  if (text.size() <= longest) return std::string(text);
  std::size_t end = longest;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;  // within a character
  return fmt::format("{}... ({} bytes)", text.substr(0, end), text.size());
}

bool has_control_character(std::string_view text) {
  while (!text.empty()) {
    const Character one = first_of(text);
    if (one.control) return true;
    text.remove_prefix(one.bytes.size());
  }
  return false;
}

std::string printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const Character one = first_of(text);
    if (one.whole && (!one.control || one.bytes == "\n" || one.bytes == "\t")) {
      out += one.bytes;
    } else {  // one byte, or the second of a C1 character, which is its number
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(one.bytes.back()));
    }
    text.remove_prefix(one.bytes.size());
  }
  return out;
}

bool is_utf8(std::string_view text) {
  try {
    static_cast<void>(nlohmann::json(text).dump());
    return true;
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

}  // namespace bb
