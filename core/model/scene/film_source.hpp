// Where a film comes from, as a config states it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/parameters/parameter.hpp"
#include "core/model/scene/film.hpp"

namespace bb {

/// A file with the SHA-256 of its bytes, hex.
struct HashedFile {
  std::string path, sha256;
};

/// A generator with its parameters, or numbered mesh files (core/model/mesh/film_file.hpp), and when their frames are.
struct FilmSource {
  std::string generator;                            // empty when there are files
  ParameterMap parameters;                          // of the generator, complete
  std::vector<HashedFile> files;                    // absolute, in their order
  HashedFile times_file;                            // that says the times; none: frame_time or times do
  std::string sha256;                               // of the hashes of all files, hex
  std::optional<double> frame_time = std::nullopt;  // s from frame to frame
  std::vector<double> times;                        // s, of every frame; empty: k frame_time
  double start = 0;                                 // s, that is added to every time
  FilmInterpolation between = FilmInterpolation::linear;

  bool given() const { return !generator.empty() || !files.empty(); }
};

}  // namespace bb
