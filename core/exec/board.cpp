#include "core/exec/board.hpp"

#include <algorithm>
#include <stdexcept>

namespace bb::exec {

std::size_t Board::take(std::size_t bytes) {
  const auto same =
      std::find_if(free_.begin(), free_.end(), [=](const Place& p) { return p.bytes == bytes; });
  if (same != free_.end()) {
    const std::size_t at = same->at;
    free_.erase(same);
    written();
    return at;
  }
  const std::size_t at = used_;
  if (at + bytes > capacity) throw std::logic_error("more numbers are read than the board can hold");
  used_ = (at + bytes + 15) / 16 * 16;
  written();
  return at;
}

const std::byte* Board::read(std::size_t at) {
  if (!fresh_) {
    here_.resize(used_);
    memory_.download_first(here_);
    fresh_ = true;
  }
  return here_.data() + at;
}

}  // namespace bb::exec
