#include "experiments/cli/terminal.hpp"
#include "experiments/cli/say.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <cstring>

namespace bb::cli {
namespace {

/// Bytes of the first n characters.
std::size_t bytes_of(std::string_view text, std::size_t n) {
  std::size_t at = 0;
  for (; at < text.size(); ++at) {
    if ((text[at] & 0xC0) != 0x80 && n-- == 0) break;
  }
  return at;
}

}  // namespace

std::size_t characters(std::string_view text) {
  return static_cast<std::size_t>(  // bytes that continue none
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::size_t terminal_columns(int descriptor) {
  if (const char* told = std::getenv("BENCH_COLUMNS"); told && descriptor == STDOUT_FILENO) {
    std::size_t columns = 0;
    std::from_chars(told, told + std::strlen(told), columns);
    return columns;
  }
  struct winsize size {};
  if (!::isatty(descriptor) || ::ioctl(descriptor, TIOCGWINSZ, &size) != 0) return 0;
  return size.ws_col;
}

std::string shortened_to(std::string_view text, std::size_t columns) {
  if (columns == 0 || characters(text) <= columns) return std::string(text);
  if (columns < 4) return std::string(text.substr(0, bytes_of(text, columns)));
  return std::string(text.substr(0, bytes_of(text, columns - 3))) + "...";
}

std::string wrapped(std::string_view text, std::size_t columns, std::size_t indent) {
  if (columns <= indent + 20) return std::string(text);  // too narrow to break anything
  std::string out;
  for (bool first = true; !text.empty(); first = false) {
    const std::size_t room = first ? columns : columns - indent;
    if (!first) out += "\n" + std::string(indent, ' ');
    if (characters(text) <= room) return out + std::string(text);
    const std::size_t most = bytes_of(text, room);
    const std::size_t words = text.find_first_not_of(' ');
    std::size_t end = text.rfind(' ', most);
    if (end == std::string_view::npos || end <= words) end = text.find(' ', most);
    out += text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end);
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  }
  return out;
}

void print_wrapped(std::string_view line, std::size_t indent) {
  show("{}\n", wrapped(line, terminal_columns(STDOUT_FILENO), indent));
}

}  // namespace bb::cli
