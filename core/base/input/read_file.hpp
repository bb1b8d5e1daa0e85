// The one place that opens a file named by a user.
#pragma once

#include <cstdint>
#include <string>

namespace bb {

/// A kind of input file: its name for messages and the largest size that is read. The whole file is held in
/// memory, and what is parsed from it takes several times its size.
struct InputKind {
  const char* what;
  std::uint64_t max_bytes;
  bool or_standard_input = false;  // the path - is the standard input, which is read once and kept
};

inline constexpr InputKind config_file{"a config file (- reads the standard input)", std::uint64_t{16} << 20,
                                       true};
inline constexpr InputKind sweep_file{"a sweep file", std::uint64_t{16} << 20};
inline constexpr InputKind record_file{"a record", std::uint64_t{256} << 20};
inline constexpr InputKind mesh_file{"a mesh file (.obj, .ply, .stl, .msh, .vtk, .vtu, .vtp)",
                                     std::uint64_t{1} << 30};
inline constexpr InputKind weights_file{"a file of weights (a number a line)", std::uint64_t{256} << 20};
inline constexpr InputKind matrix_file{"a Matrix Market file (.mtx)", std::uint64_t{1} << 30};
inline constexpr InputKind side_car_file{"the side-car of a matrix (.json)", std::uint64_t{256} << 20};
inline constexpr InputKind query_file{"a file of JSON Lines (- reads the standard input, pipes too)",
                                      std::uint64_t{1} << 62};  // read line by line
inline constexpr InputKind plugin_file{"a shared library", std::uint64_t{256} << 20};

/// Errors: ConfigError at `path` when it is empty, absent, unreadable, or no regular file (folder, FIFO,
/// device, socket): opening those can wait for ever. Opens nothing but a regular file.
void require_regular_file(const std::string& path, const InputKind& kind);

/// The bytes of a regular file, or of the standard input where the kind has it. Errors: ConfigError as require_regular_file, and for a file larger than
/// kind.max_bytes, of which no more than that is read.
std::string read_input_file(const std::string& path, const InputKind& kind);

}  // namespace bb
