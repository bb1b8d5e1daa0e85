// Signed numbers of items as what std containers count by.
#pragma once

#include <cstddef>
#include <cstdint>

namespace bb {

/// i as an index; i >= 0.
constexpr std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

}  // namespace bb
