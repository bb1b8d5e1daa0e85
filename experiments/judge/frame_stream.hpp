// Frames as they come: 3 little-endian doubles a vertex, x y z in m, frame after frame, without any header.
#pragma once

#include <iosfwd>

#include "core/math/types.hpp"

namespace bb::judge {

class FrameStream {
 public:
  FrameStream(std::istream& in, int n_vertices) : in_(in), n_vertices_(n_vertices) {}

  /// Reads the next frame into x [3 n_vertices], m. False at the end. Errors: ConfigError where the stream ends within a
  /// frame. Numbers that are not finite are the judge's.
  bool next(Positions& x);

  long frames() const { return frames_; }

 private:
  std::istream& in_;
  int n_vertices_;
  long frames_ = 0;
};

}  // namespace bb::judge
