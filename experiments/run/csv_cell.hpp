// A text as one cell of a CSV file (RFC 4180): quoted where it holds a comma, a quote or the end of a line.
#pragma once

#include <string>

namespace bb {

inline std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

}  // namespace bb
