// Four boxes against one: lanes on a host, a loop where nvcc compiles, which knows no vectors. Comparisons and no arithmetic, so
// both say the same.
#pragma once

#include <cstdint>

#include "core/math/host_device.hpp"

#if !defined(__CUDACC__) && defined(__SSE2__)
#include <immintrin.h>
#endif

namespace bb::exec {

/// Siblings of a tree.
constexpr int tree_width = 4;

/// Bit k where box k of the four overlaps [a_lo, a_hi] and bit 0 of one of the two tags is set. Clear where a number is none.
BB_HD inline unsigned overlapping(const float (&lo)[3][tree_width], const float (&hi)[3][tree_width],
                                  const std::uint32_t (&tag)[tree_width], const float (&a_lo)[3],
                                  const float (&a_hi)[3], std::uint32_t a_tag) {
#if !defined(__CUDACC__) && defined(__SSE2__)
  const __m128i tags = _mm_or_si128(_mm_loadu_si128(reinterpret_cast<const __m128i*>(tag)),
                                    _mm_set1_epi32(static_cast<int>(a_tag)));
  __m128 meet = _mm_castsi128_ps(_mm_slli_epi32(tags, 31));  // the sign is what is asked
  for (int c = 0; c < 3; ++c) {
    meet = _mm_and_ps(meet, _mm_cmple_ps(_mm_set1_ps(a_lo[c]), _mm_loadu_ps(hi[c])));
    meet = _mm_and_ps(meet, _mm_cmple_ps(_mm_loadu_ps(lo[c]), _mm_set1_ps(a_hi[c])));
  }
  return static_cast<unsigned>(_mm_movemask_ps(meet));
#else
  unsigned out = 0;
  for (int k = 0; k < tree_width; ++k) {
    const int along[3] = {(a_lo[0] <= hi[0][k]) & (lo[0][k] <= a_hi[0]),
                          (a_lo[1] <= hi[1][k]) & (lo[1][k] <= a_hi[1]),
                          (a_lo[2] <= hi[2][k]) & (lo[2][k] <= a_hi[2])};
    out |= ((a_tag | tag[k]) & static_cast<unsigned>(along[0] & along[1] & along[2])) << k;
  }
  return out;
#endif
}

}  // namespace bb::exec
