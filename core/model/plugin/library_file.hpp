// What can be checked of a plugin's file before its code runs in this process. Internal to this module.
#pragma once

#include <functional>
#include <string>

namespace bb {

/// Errors: ConfigError at the file: no regular file, larger than plugin_file allows, no 64-bit ELF shared
/// library, or one whose headers, segments or section table reach beyond its end (a file that was cut).
void check_library_file(const std::string& file);

/// The same of its bytes; `file` is used in messages. Errors: ConfigError at the file.
void check_library_bytes(const std::string& bytes, const std::string& file);

/// Runs `load` in a child process first, which has 10 s. What it throws is left to the caller's own call.
/// Errors: ConfigError at the file when the child ends in any other way than at the end of `load`: by a
/// signal, by exit(), or not at all.
void try_in_child(const std::string& file, const std::function<void()>& load);

}  // namespace bb
