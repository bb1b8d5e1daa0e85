// Sets of eight lanes: which of eight comparisons hold, and eight numbers with those of a set moved to the front.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/math/lanes.hpp"

#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace bb {

/// A set of lanes, bit k for lane k.
using LaneSet = std::uint32_t;

using EightFloats = VectorOf<float, 8>::type;
using EightInts = VectorOf<std::int32_t, 8>::type;

/// The lanes of a comparison that hold.
inline LaneSet lanes_of(const EightInts& comparison) {
#ifdef __AVX2__
  return static_cast<LaneSet>(_mm256_movemask_ps(reinterpret_cast<__m256>(comparison)));
#else
  LaneSet lanes = 0;
  for (int k = 0; k < 8; ++k) lanes |= static_cast<LaneSet>(comparison[k] & 1) << k;
  return lanes;
#endif
}

namespace detail {

/// For every set its lanes in ascending order, 0 padded.
constexpr auto lanes_in_order = [] {
  std::array<std::array<std::uint8_t, 8>, 256> out{};
  for (std::size_t lanes = 0; lanes < 256; ++lanes) {
    std::size_t n = 0;
    for (std::size_t k = 0; k < 8; ++k) {
      if ((lanes >> k & 1) != 0) out[lanes][n++] = static_cast<std::uint8_t>(k);
    }
  }
  return out;
}();

}  // namespace detail

/// Writes the numbers of the lanes of a set in ascending order of the lanes; always eight numbers, of which those
/// beyond the set mean nothing. Returns how many the set has.
inline std::size_t pack(const EightInts& numbers, LaneSet lanes, std::int32_t* out) {
  const auto& order = detail::lanes_in_order[lanes];
#ifdef __AVX2__
  const __m256i index = _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(order.data())));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(out),
                      _mm256_permutevar8x32_epi32(reinterpret_cast<__m256i>(numbers), index));
#else
  for (std::size_t k = 0; k < 8; ++k) out[k] = numbers[order[k]];
#endif
  return static_cast<std::size_t>(std::popcount(lanes));
}

}  // namespace bb
