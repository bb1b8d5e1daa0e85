#include "core/input/names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace bb {
namespace {

std::string fault_of(std::string_view name) {
  if (name.empty()) return "an empty name";
  if (name.size() > max_name_bytes) {
    return fmt::format("a name of {} bytes, \"{}...\"", name.size(), name.substr(0, 20));
  }
  const bool control = std::any_of(name.begin(), name.end(),
                                   [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
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

bool is_utf8(std::string_view text) {
  try {
    static_cast<void>(nlohmann::json(text).dump());
    return true;
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

}  // namespace bb
