// How wide the terminal is, and text that keeps to it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace bb::cli {

/// Columns of the terminal that a stream (STDOUT_FILENO, STDERR_FILENO) is; 0: it is none, and lines may be of any length.
/// BENCH_COLUMNS stands for that of the standard output: a sweep passes it to the processes of its runs.
std::size_t terminal_columns(int descriptor);

/// How many characters of UTF-8 a text has.
std::size_t characters(std::string_view text);

/// At most so many characters, a longer text with an ellipsis at its end; 0: all of them.
std::string shortened_to(std::string_view text, std::size_t columns);

/// Broken at blanks into lines of at most so many characters, those after the first indented; 0: one line. A word is never broken.
std::string wrapped(std::string_view text, std::size_t columns, std::size_t indent);

/// Prints a line on stdout, wrapped where that is a terminal.
void print_wrapped(std::string_view line, std::size_t indent);

}  // namespace bb::cli
