// What verbs say. Words on stderr can never end a run: a stderr that is closed, full or not read is passed over.
#pragma once

#include <fmt/format.h>

#include <string_view>
#include <utility>

namespace bb::cli {

/// Writes the text; control characters in it are shown, not sent (printable() in core/base/input/names.hpp).
void say(std::string_view text);
/// The same to the standard output, where answers go. Errors: as those of fmt::print.
void show_text(std::string_view text);
template <class... Values>
void show(fmt::format_string<Values...> format, Values&&... values) {
  show_text(fmt::format(format, std::forward<Values>(values)...));
}
/// As say, in place of the line where the cursor of a terminal is.
void rewrite_line(std::string_view text);

/// To be called first. A descriptor 0, 1 or 2 that the caller closed is taken, so that no file that is opened
/// later gets its number and with it our output; writing to it still fails. A file that grows beyond the
/// limit of the system (ulimit -f) is an error like a full disk, no signal.
void prepare_streams();

}  // namespace bb::cli
