// The file that this code was loaded from.
#pragma once

#include <string>

namespace bb {

/// What build_id is the hash of: /proc/self/exe, or the library with this code where another program has loaded it, such as
/// Python its module.
std::string program_file();

}  // namespace bb
