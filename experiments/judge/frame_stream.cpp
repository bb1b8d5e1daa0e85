#include "experiments/judge/frame_stream.hpp"

#include <fmt/format.h>

#include <bit>
#include <istream>

#include "core/math/error.hpp"

namespace bb::judge {

static_assert(std::endian::native == std::endian::little, "frames are little-endian");

bool FrameStream::next(Positions& x) {
  x.resize(3, n_vertices_);
  const auto wanted = static_cast<std::streamsize>(sizeof(double)) * x.size();
  in_.read(reinterpret_cast<char*>(x.data()), wanted);
  if (in_.gcount() == 0) return false;
  if (in_.gcount() != wanted) {
    throw ConfigError(fmt::format("standard input, frame {}", frames_), fmt::format("{} bytes", in_.gcount()),
                      fmt::format("{}: 24 for each of {} vertices", wanted, n_vertices_));
  }
  ++frames_;
  return true;
}

}  // namespace bb::judge
